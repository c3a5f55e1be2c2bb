#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/host_state.h"
#include "engine/gl/texture.h"
#include "tests/core/error_of.h"
#include "tests/embed/host_context.h"
#include "tests/embed/world.h"
#include "tests/gl/poison_objects.h"

namespace viscera::test {

/// A host with a context, a framebuffer of its own that is bound, and state that it wants back.
class EmbedTest : public testing::TestWithParam<HostContext::Kind> {
  protected:
    EmbedTest();
    /// Fails when an OpenGL error is left.
    void TearDown() override;

    [[nodiscard]] const gl::Functions& gl() const { return *gl_; }
    [[nodiscard]] HostContext& context() { return context_; }
    [[nodiscard]] const World& world() const { return world_; }
    [[nodiscard]] const Registry& registry() const { return registry_; }
    [[nodiscard]] Renderer make_renderer() { return {context_.proc(), registry_, options()}; }
    /// Messages that are worth a look are kept in complaints().
    [[nodiscard]] RendererOptions options();
    [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

    /// Sets every state row to what no one expects, until unpoison().
    void poison();
    void unpoison();

    /// Runs a call of viscera's and fails for each state row that it does not leave as it was, and for an
    /// error.
    template <class Call>
    void expect_untouched(const char* what, Call&& call) {
        const gl::HostState before = saved();
        call();
        const gl::HostState after = saved();
        EXPECT_EQ(after.host_errors(), 0U) << what << " leaves an OpenGL error";
        EXPECT_EQ(changed_rows(before, after), std::vector<std::string>{}) << what;
    }

    /// The pictures of a scene in another context of the same kind, with nothing poisoned.
    [[nodiscard]] std::map<std::string, Image> clean_pictures(const Scene& scene, const HostValues* values,
                                                              double time_s = World::time_s);

  private:
    [[nodiscard]] gl::HostState saved();
    [[nodiscard]] static std::vector<std::string> changed_rows(const gl::HostState& a,
                                                               const gl::HostState& b);

    HostContext context_;
    std::unique_ptr<const gl::Functions> gl_;
    World world_;
    Registry registry_;
    Log log_;
    std::vector<std::string> complaints_;
    std::optional<ScopedPoison> host_;
    std::optional<ScopedPoison> poison_;
    std::optional<gl::HostState> before_poison_;
};

/// A framebuffer of the host's own, filled with one colour.
struct HostCanvas {
    HostCanvas(const gl::Functions& gl, int width, int height, PixelFormat format = PixelFormat::rgba8);
    [[nodiscard]] Image read(const gl::Functions& gl) const;

    gl::Texture texture;
    gl::Framebuffer framebuffer;
    static constexpr std::array<float, 4> colour{0.2F, 0.4F, 0.6F, 0.8F};
};

}  // namespace viscera::test
