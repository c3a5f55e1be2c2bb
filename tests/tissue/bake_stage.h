#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/context/context.h"
#include "engine/core/mesh_data.h"
#include "engine/runtime/renderer.h"
#include "tests/io/temp_folder.h"
#include "tests/reference/tissue_bake.h"

namespace viscera::test {

/// The four targets of a bake as floats.
struct Baked {
    int width = 0;
    int height = 0;
    Image position;
    Image normal;
    Image metric;
    Image seam;

    [[nodiscard]] glm::vec4 at(const Image& image, int x, int y) const {
        glm::vec4 value(0.0F);
        for (int c = 0; c < image.channels(); ++c) {
            value[c] = image.at(x, y, c);
        }
        return value;
    }
    [[nodiscard]] bool inside(int x, int y) const { return position.at(x, y, 3) == 1.0F; }
    [[nodiscard]] bool gutter(int x, int y) const { return position.at(x, y, 3) == 0.5F; }
    [[nodiscard]] glm::dvec2 uv(int x, int y) const { return {(x + 0.5) / width, (y + 0.5) / height}; }
};

/// tissue.bake of one mesh in a renderer of its own.
class BakeStage {
  public:
    explicit BakeStage(std::filesystem::path cache_folder = {});
    ~BakeStage() { context_->make_current(); }

    nlohmann::json parameters;  ///< of the pass
    bool all_outputs = true;    ///< else positions alone

    /// Writes a mesh as OBJ, with every digit, and bakes that.
    void use(const MeshData& mesh);
    [[nodiscard]] Baked bake(const HostValues* values = nullptr);
    const FrameReport& render(const HostValues* values = nullptr);
    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    [[nodiscard]] const std::vector<std::string>& said() const { return said_; }
    /// Whether some message has these words.
    [[nodiscard]] bool has_said(const std::string& words) const;
    [[nodiscard]] const std::vector<std::string>& long_work() const { return long_work_; }
    [[nodiscard]] const TempFolder& folder() const { return folder_; }

  private:
    void load();

    TempFolder folder_;
    std::vector<std::string> said_;
    std::vector<std::string> long_work_;
    std::unique_ptr<Context> context_;
    Registry registry_;
    std::unique_ptr<Renderer> renderer_;
    nlohmann::json loaded_;
};

/// A sheet of n x m cells from a map of (s, t) in [0, 1]^2 to space, and one to texture coordinates.
[[nodiscard]] MeshData sheet(int n, int m, const std::function<glm::dvec3(double, double)>& place,
                             const std::function<glm::dvec2(double, double)>& uv);
/// Both as one mesh.
[[nodiscard]] MeshData together(const MeshData& a, const MeshData& b);
[[nodiscard]] reference::BakedSurface surface_of(const MeshData& mesh);
/// Units in the last place between two floats, for values of this size.
[[nodiscard]] double ulps(double difference, double size);

}  // namespace viscera::test
