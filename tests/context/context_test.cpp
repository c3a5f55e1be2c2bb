#include "engine/context/context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "engine/gl/functions.h"
#include "tests/context/offscreen.h"
#include "tests/core/error_of.h"

namespace viscera {
namespace {

using test::clear_and_read;
using test::error_of;
using test::mark;
using test::read_mark;
using test::Rgba8;
using testing::ElementsAre;

std::string name_of(const testing::TestParamInfo<Backend>& info) {
    std::string name(to_string(info.param));
    std::ranges::replace(name, '-', '_');
    return name;
}

class Offscreen : public testing::TestWithParam<Backend> {};
INSTANTIATE_TEST_SUITE_P(Backends, Offscreen,
                         testing::Values(Backend::egl_device, Backend::egl_surfaceless, Backend::osmesa),
                         name_of);

TEST_P(Offscreen, ClearsAndReadsBack) {
    const auto context = create_context(GetParam());
    const auto gl = gl::Functions::load(context->proc_address());
    EXPECT_EQ(clear_and_read(*gl, {0.2F, 0.4F, 0.6F, 0.8F}), (Rgba8{51, 102, 153, 204}));
    EXPECT_EQ(gl->GetError(), GLenum{GL_NO_ERROR});
}

TEST_P(Offscreen, TellsWhatItIs) {
    const auto context = create_context(GetParam());
    const ContextInfo& info = context->info();
    EXPECT_EQ(info.backend, GetParam());
    EXPECT_FALSE(info.vendor.empty());
    EXPECT_FALSE(info.renderer.empty());
    EXPECT_TRUE(info.version.starts_with(std::to_string(info.major) + "." + std::to_string(info.minor)));
    EXPECT_GE(info.major * 10 + info.minor, 33);
    EXPECT_EQ(info.egl_device.has_value(), GetParam() == Backend::egl_device);
    if (info.renderer.find("llvmpipe") != std::string::npos) {
        EXPECT_TRUE(info.software);
    }
}

TEST_P(Offscreen, IsACoreContext) {
    const auto context = create_context(GetParam());
    const auto gl = gl::Functions::load(context->proc_address());
    GLint profile = 0;
    gl->GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
}

TEST_P(Offscreen, TwoOfOneKindAreApart) {
    const auto first = create_context(GetParam());
    const auto first_gl = gl::Functions::load(first->proc_address());
    mark(*first_gl, 0.25F);
    const auto second = create_context(GetParam());
    const auto second_gl = gl::Functions::load(second->proc_address());
    EXPECT_EQ(read_mark(*second_gl), 0.0F);
    mark(*second_gl, 0.5F);
    first->make_current();
    EXPECT_EQ(read_mark(*first_gl), 0.25F);
    second->make_current();
    EXPECT_EQ(read_mark(*second_gl), 0.5F);
}

TEST_P(Offscreen, DestroyingAnotherLeavesTheCurrentOneCurrent) {
    const auto kept = create_context(GetParam());
    const auto gl = gl::Functions::load(kept->proc_address());
    mark(*gl, 0.25F);
    auto gone = create_context(GetParam());
    kept->make_current();
    gone.reset();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST_P(Offscreen, ReleasedItCanGoToAnotherThread) {
    const auto context = create_context(GetParam());
    const auto gl = gl::Functions::load(context->proc_address());
    mark(*gl, 0.25F);
    context->release();
    float seen = 0.0F;
    std::thread([&] {
        context->make_current();
        seen = read_mark(*gl);
        context->release();
    }).join();
    EXPECT_EQ(seen, 0.25F);
    context->make_current();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

// EGL and OSMesa share Mesa's slot for the current context: without a release between them the calls for one
// go to the other.
class Alternating : public testing::TestWithParam<std::pair<Backend, Backend>> {};
INSTANTIATE_TEST_SUITE_P(
    Backends, Alternating,
    testing::Values(std::pair{Backend::egl_device, Backend::osmesa},
                    std::pair{Backend::osmesa, Backend::egl_device},
                    std::pair{Backend::egl_surfaceless, Backend::osmesa},
                    std::pair{Backend::egl_device, Backend::egl_surfaceless}),
    [](const auto& info) {
        return name_of({info.param.first, info.index}) + "_and_" + name_of({info.param.second, info.index});
    });

TEST_P(Alternating, CallsReachTheContextMadeCurrent) {
    const auto first = create_context(GetParam().first);
    const auto first_gl = gl::Functions::load(first->proc_address());
    mark(*first_gl, 0.25F);
    const auto second = create_context(GetParam().second);
    const auto second_gl = gl::Functions::load(second->proc_address());
    mark(*second_gl, 0.5F);
    for (int round = 0; round < 3; ++round) {
        first->make_current();
        ASSERT_EQ(read_mark(*first_gl), 0.25F) << "round " << round;
        ASSERT_EQ(clear_and_read(*first_gl, {1.0F, 0.0F, 0.0F, 1.0F}), (Rgba8{255, 0, 0, 255}));
        second->make_current();
        ASSERT_EQ(read_mark(*second_gl), 0.5F) << "round " << round;
        ASSERT_EQ(clear_and_read(*second_gl, {0.0F, 1.0F, 0.0F, 1.0F}), (Rgba8{0, 255, 0, 255}));
    }
}

TEST_P(Alternating, TheFirstOutlivesTheSecond) {
    const auto first = create_context(GetParam().first);
    const auto gl = gl::Functions::load(first->proc_address());
    mark(*gl, 0.25F);
    create_context(GetParam().second).reset();
    first->make_current();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST(CallersContext, IsWrappedAndBoundAgain) {
    const auto host = create_context(Backend::egl_surfaceless);
    const auto gl = gl::Functions::load(host->proc_address());
    mark(*gl, 0.25F);
    const auto wrapped = wrap_current_context(host->proc_address());
    EXPECT_EQ(wrapped->info().backend, Backend::current);
    EXPECT_EQ(wrapped->info().renderer, host->info().renderer);

    const auto other = create_context(Backend::osmesa);
    wrapped->release();  // not current, so nothing happens
    mark(*gl::Functions::load(other->proc_address()), 0.5F);
    wrapped->make_current();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST(CallersContext, OfOsmesaIsBoundAgain) {
    const auto host = create_context(Backend::osmesa);
    const auto gl = gl::Functions::load(host->proc_address());
    mark(*gl, 0.25F);
    const auto wrapped = wrap_current_context(host->proc_address());
    const auto other = create_context(Backend::egl_surfaceless);
    wrapped->make_current();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST(CallersContext, SurvivesItsWrapper) {
    const auto host = create_context(Backend::egl_surfaceless);
    const auto gl = gl::Functions::load(host->proc_address());
    mark(*gl, 0.25F);
    wrap_current_context(host->proc_address()).reset();
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST(CallersContext, NoneCurrentIsRefused) {
    const auto host = create_context(Backend::egl_surfaceless);
    host->release();
    const auto error = error_of([&] { (void)wrap_current_context(host->proc_address()); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::context);
    EXPECT_THAT(error->what(), testing::HasSubstr("no OpenGL context is current"));
}

TEST(Probe, ReportsEveryBackendAndKeepsTheCurrentContext) {
    const auto host = create_context(Backend::egl_surfaceless);
    const auto gl = gl::Functions::load(host->proc_address());
    mark(*gl, 0.25F);
    const auto reports = probe_backends();
    std::vector<Backend> backends;
    for (const BackendReport& report : reports) {
        backends.push_back(report.backend);
        EXPECT_TRUE(report.info || !report.why.empty()) << to_string(report.backend);
    }
    backends.erase(std::unique(backends.begin(), backends.end()), backends.end());
    EXPECT_THAT(backends,
                ElementsAre(Backend::egl_device, Backend::egl_surfaceless, Backend::osmesa, Backend::glfw));
    EXPECT_EQ(read_mark(*gl), 0.25F);
}

TEST(BackendNames, AreParsedAndPrinted) {
    for (const Backend backend :
         {Backend::egl_device, Backend::egl_surfaceless, Backend::osmesa, Backend::glfw, Backend::current}) {
        EXPECT_THAT(parse_backends(to_string(backend)), ElementsAre(backend));
    }
    EXPECT_THAT(parse_backends("auto"),
                ElementsAre(Backend::egl_device, Backend::egl_surfaceless, Backend::osmesa));
    EXPECT_THAT(parse_backends("egl"), ElementsAre(Backend::egl_device, Backend::egl_surfaceless));
}

TEST(BackendNames, AnotherWordIsAUsageError) {
    const auto error = error_of([] { (void)parse_backends("vulkan"); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
    EXPECT_THAT(error->what(), testing::HasSubstr("'vulkan' is none of auto, egl,"));
}

}  // namespace
}  // namespace viscera
