#include "engine/gl/functions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "engine/gl/capabilities.h"
#include "engine/gl/debug.h"
#include "tests/core/error_of.h"

namespace viscera {
namespace {

using test::error_of;
using testing::HasSubstr;

// Loaders that lie. A ProcAddress holds no state, so each is a function of its own.
const GLubyte* es_version(GLenum) {
    return reinterpret_cast<const GLubyte*>("OpenGL ES 3.2 Mesa");
}
const GLubyte* old_version(GLenum) {
    return reinterpret_cast<const GLubyte*>("3.2.0 Core");
}
const GLubyte* no_version(GLenum) {
    return nullptr;
}
template <const GLubyte* (*Version)(GLenum)>
void* only_get_string(const char* name) {
    return std::strcmp(name, "glGetString") == 0 ? reinterpret_cast<void*>(Version) : nullptr;
}

std::string refusal_of(ProcAddress proc) {
    const auto error = error_of([&] { (void)gl::Functions::load(proc); });
    return error && error->code() == ErrorCode::context ? error->what() : "";
}

TEST(Functions, RefusesWhatIsNoOpenGl33) {
    EXPECT_THAT(refusal_of(nullptr), HasSubstr("no function was given"));
    EXPECT_THAT(refusal_of([](const char*) -> void* { return nullptr; }), HasSubstr("finds no OpenGL"));
    EXPECT_THAT(refusal_of(only_get_string<no_version>), HasSubstr("no OpenGL context is current"));
    EXPECT_THAT(refusal_of(only_get_string<es_version>), HasSubstr("'OpenGL ES 3.2 Mesa'"));
    EXPECT_THAT(refusal_of(only_get_string<old_version>), HasSubstr("'3.2.0 Core'"));
}

class WithContext : public testing::Test {
  protected:
    /// A loader that does not know one function of core 3.3.
    static void* without_sampler_objects(const char* name) {
        return std::strcmp(name, "glGenSamplers") == 0 ? nullptr : real_(name);
    }
    /// A loader that makes of the context one of version 3.3 without extensions that viscera knows.
    static void* as_plain_33(const char* name) {
        const auto version = [](GLenum what) {
            return what == GL_VERSION ? reinterpret_cast<const GLubyte*>("3.3 (Core Profile)")
                                      : reinterpret_cast<PFNGLGETSTRINGPROC>(real_("glGetString"))(what);
        };
        const auto extension = [](GLenum, GLuint) {
            return reinterpret_cast<const GLubyte*>("GL_VISCERA_none");
        };
        if (std::strcmp(name, "glGetString") == 0) {
            return reinterpret_cast<void*>(PFNGLGETSTRINGPROC{version});
        }
        if (std::strcmp(name, "glGetStringi") == 0) {
            return reinterpret_cast<void*>(PFNGLGETSTRINGIPROC{extension});
        }
        return real_(name);
    }
    void SetUp() override { real_ = context_->proc_address(); }

    static inline ProcAddress real_ = nullptr;
    std::unique_ptr<Context> context_ = create_context(Backend::egl_surfaceless);
};

TEST_F(WithContext, NamesAMissingFunction) {
    EXPECT_THAT(refusal_of(without_sampler_objects), HasSubstr("lacks glGenSamplers"));
    EXPECT_NO_THROW((void)gl::Functions::load(real_));
}

TEST_F(WithContext, Above33AreNullWhereTheVersionDoesNotHaveThem) {
    // Loaders hand out pointers all the same: only version and extension strings tell.
    ASSERT_NE(as_plain_33("glDispatchCompute"), nullptr);
    const auto gl = gl::Functions::load(as_plain_33);
    EXPECT_EQ(gl->DispatchCompute, nullptr);
    EXPECT_EQ(gl->BufferStorage, nullptr);
    EXPECT_NE(gl->GenSamplers, nullptr);
    const auto capabilities = gl::Capabilities::query(*gl);
    EXPECT_FALSE(capabilities.compute);
    EXPECT_FALSE(gl::has_debug(*gl));
}

TEST_F(WithContext, WithoutKhrDebugItsHelpersDoNothing) {
    const auto gl = gl::Functions::load(as_plain_33);
    ASSERT_EQ(gl->PushDebugGroup, nullptr);
    Log log;
    const gl::DebugMessages messages(*gl, log);
    EXPECT_FALSE(messages.active());
    const gl::DebugGroup group(*gl, "frame");
    gl::label_object(*gl, GL_TEXTURE, 1, "nothing");
    EXPECT_EQ(gl->GetError(), GLenum{GL_NO_ERROR});
}

TEST_F(WithContext, CapabilitiesReachTheLimitsThatCore33Promises) {
    const auto gl = gl::Functions::load(real_);
    const auto c = gl::Capabilities::query(*gl);
    EXPECT_EQ(c.software, context_->info().software);
    EXPECT_GE(c.max_texture_2d, 1024);
    EXPECT_EQ(c.gpu_timers(), c.timer_bits > 0 && !c.software);
    EXPECT_EQ(gl->GetError(), GLenum{GL_NO_ERROR});
}

}  // namespace
}  // namespace viscera
