#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/context/context.h"
#include "engine/core/error.h"
#include "engine/gl/functions.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/renderer.h"
#include "tests/io/temp_folder.h"

namespace viscera::test {

using Pictures = std::map<std::string, Image>;

/// The whole contrast chain on a small tube, rendered off screen. The tube of radius 2 mm runs along z from 0
/// to 20 mm; its file gives density 0.8 to each vertex.
class Stage : public testing::Test {
  protected:
    Stage();
    ~Stage() override;

    /// Vessels, cloud, summary, smoke of one emitter, blush, picture: 64 x 48.
    [[nodiscard]] static nlohmann::json chain();
    /// The same with the mesh's own densities and without an injection.
    [[nodiscard]] static nlohmann::json per_vertex_chain();
    /// Writes a tube whose vertices have these densities (by number of the vertex).
    void write_tube(const std::string& name, const std::function<float(int)>& density = {});

    void load(const nlohmann::json& scene);
    [[nodiscard]] Pictures render(const Frame& frame);
    /// Every target of one picture; fails unless each value is finite.
    [[nodiscard]] Pictures render(double time_s = 1.0) { return render(renderer().still(time_s)); }
    [[nodiscard]] Pictures render(const nlohmann::json& scene, double time_s = 1.0) {
        load(scene);
        return render(time_s);
    }
    /// How often a survivable fault was counted, and that it was said exactly once.
    void expect_said_once(const std::string& key, const std::string& words);

    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    [[nodiscard]] const gl::Functions& gl() const { return *functions_; }
    [[nodiscard]] const TempFolder& folder() const { return folder_; }
    [[nodiscard]] std::string said() const;

  private:
    TempFolder folder_;
    std::vector<std::string> messages_;
    std::unique_ptr<Context> context_;
    std::unique_ptr<const gl::Functions> functions_;
    Registry registry_;
    std::optional<Renderer> renderer_;
};

inline constexpr int tube_vertices = 12 * 11;

/// Every value of every picture.
void expect_finite(const Pictures& pictures);
void expect_same(const Image& a, const Image& b, const std::string& what);
[[nodiscard]] float largest(const Image& image);

}  // namespace viscera::test
