#include "tests/gl/gl_test.h"

#include <algorithm>

namespace viscera::test {

namespace {

ContextOptions debug_options() {
    ContextOptions options;
    options.debug = true;
    return options;
}

}  // namespace

GlTest::GlTest()
    : log_([this](LogLevel level, std::string_view message) {
          if (level == LogLevel::error || level == LogLevel::warning) {
              complaints_.emplace_back(message);
          }
      }),
      context_(create_context(GetParam(), debug_options())),
      functions_(gl::Functions::load(context_->proc_address())) {
    messages_.emplace(*functions_, log_);
}

void GlTest::TearDown() {
    const GLenum error = gl::drain_errors(gl());
    if (!expects_messages_) {
        EXPECT_EQ(error, static_cast<GLenum>(GL_NO_ERROR)) << gl::error_name(error);
        EXPECT_TRUE(complaints_.empty()) << complaints_.front();
    }
    messages_.reset();
}

std::string backend_name(const testing::TestParamInfo<Backend>& info) {
    std::string name(to_string(info.param));
    std::ranges::replace(name, '-', '_');
    return name;
}

}  // namespace viscera::test
