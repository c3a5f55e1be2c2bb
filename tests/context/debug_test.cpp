#include "engine/gl/debug.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace viscera {
namespace {

constexpr GLenum nonsense = 0xFFFF;

class Debug : public testing::Test {
  protected:
    static std::unique_ptr<Context> make_context() {
        ContextOptions options;
        options.debug = true;
        return create_context(Backend::egl_surfaceless, options);
    }
    GLint stack_depth() const {
        GLint depth = 0;
        gl_->GetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
        return depth;
    }

    std::unique_ptr<Context> context_ = make_context();
    std::unique_ptr<const gl::Functions> gl_ = gl::Functions::load(context_->proc_address());
    std::vector<std::pair<LogLevel, std::string>> heard_;
    Log log_{[this](LogLevel level, std::string_view text) { heard_.emplace_back(level, text); }};
};

TEST_F(Debug, AnErrorReachesTheLogAtItsCall) {
    const gl::DebugMessages messages(*gl_, log_);
    ASSERT_TRUE(messages.active());
    gl_->Enable(nonsense);
    ASSERT_EQ(heard_.size(), 1U);
    EXPECT_EQ(heard_[0].first, LogLevel::error);
    EXPECT_TRUE(heard_[0].second.starts_with("OpenGL: "));
    EXPECT_THAT(heard_[0].second, testing::Not(testing::EndsWith("\n")));
    EXPECT_EQ(gl_->GetError(), GLenum{GL_INVALID_ENUM});
}

TEST_F(Debug, TheHostsCallbackAndSwitchesComeBack) {
    int hosts = 0;
    gl_->DebugMessageCallback([](GLenum, GLenum, GLuint, GLenum, GLsizei, const GLchar*,
                                 const void* user) { ++*static_cast<int*>(const_cast<void*>(user)); },
                              &hosts);
    gl_->Enable(GL_DEBUG_OUTPUT);
    gl_->Disable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    {
        const gl::DebugMessages messages(*gl_, log_);
        gl_->Enable(nonsense);
    }
    EXPECT_EQ(hosts, 0);
    EXPECT_EQ(heard_.size(), 1U);
    EXPECT_EQ(gl_->IsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS), GL_FALSE);
    EXPECT_EQ(gl_->IsEnabled(GL_DEBUG_OUTPUT), GL_TRUE);
    gl_->Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl_->Enable(nonsense);
    EXPECT_EQ(hosts, 1);
    EXPECT_EQ(heard_.size(), 1U);
}

TEST_F(Debug, ObjectsCarryTheirLabels) {
    GLuint texture = 0;
    gl_->GenTextures(1, &texture);
    gl_->BindTexture(GL_TEXTURE_2D, texture);
    std::array<char, 512> text{};
    gl::label_object(*gl_, GL_TEXTURE, texture, "contrast.main");
    gl_->GetObjectLabel(GL_TEXTURE, texture, text.size(), nullptr, text.data());
    EXPECT_STREQ(text.data(), "contrast.main");

    gl::label_object(*gl_, GL_TEXTURE, texture, std::string(100'000, 'x'));
    gl_->GetObjectLabel(GL_TEXTURE, texture, text.size(), nullptr, text.data());
    EXPECT_EQ(text[0], 'x');
    gl_->DeleteTextures(1, &texture);
    EXPECT_EQ(gl_->GetError(), GLenum{GL_NO_ERROR});
}

TEST_F(Debug, GroupsOpenAndCloseWithTheirScopeAndStayOutOfTheLog) {
    const gl::DebugMessages messages(*gl_, log_);
    const GLint before = stack_depth();
    {
        const gl::DebugGroup outer(*gl_, "frame");
        const gl::DebugGroup inner(*gl_, std::string(100'000, 'x'));
        EXPECT_EQ(stack_depth(), before + 2);
    }
    EXPECT_EQ(stack_depth(), before);
    EXPECT_TRUE(heard_.empty());
    EXPECT_EQ(gl_->GetError(), GLenum{GL_NO_ERROR});
}

}  // namespace
}  // namespace viscera
