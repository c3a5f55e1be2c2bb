#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/context/context.h"
#include "engine/core/error.h"
#include "engine/gl/debug.h"
#include "engine/gl/handle.h"
#include "tests/core/error_of.h"

namespace viscera::test {

/// A context of each software backend in turn, with debug messages on. A test fails when it leaves an OpenGL
/// error or the driver complained.
class GlTest : public testing::TestWithParam<Backend> {
  public:
    GlTest();

  protected:
    void TearDown() override;
    [[nodiscard]] const gl::Functions& gl() const { return *functions_; }
    [[nodiscard]] const Context& context() const { return *context_; }
    [[nodiscard]] const ContextInfo& context_info() const { return context_->info(); }
    [[nodiscard]] Log& log() { return log_; }

    /// For tests that make OpenGL errors on purpose.
    bool expects_messages_ = false;

  private:
    std::vector<std::string> complaints_;
    Log log_;
    std::unique_ptr<Context> context_;
    std::unique_ptr<const gl::Functions> functions_;
    std::optional<gl::DebugMessages> messages_;
};

[[nodiscard]] std::string backend_name(const testing::TestParamInfo<Backend>& info);

/// Both software backends.
[[nodiscard]] inline auto each_backend() {
    return testing::Values(Backend::osmesa, Backend::egl_surfaceless);
}

}  // namespace viscera::test
