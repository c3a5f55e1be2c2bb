#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "effects/organ/organ_params.h"
#include "engine/io/mesh.h"
#include "tests/effects/deviation.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"
#include "tests/reference/organ.h"

namespace viscera::test {

/// A piece of tissue: a bent square of n x n cells, `size_mm` wide, facing -y.
struct PatchOptions {
    int cells = 10;
    double size_mm = 60.0;
    double bend_mm = 9.0;
    double uv_turn_deg = 0.0;  ///< texture coordinates turned about their middle
    double uv_scale = 1.0;     ///< < 1 keeps turned ones within the texture
    double uv_stretch = 1.0;   ///< of u alone, before the turn
    bool mirrored_uv = false;
};
/// As an OBJ file.
[[nodiscard]] std::string patch_obj(const PatchOptions& options);

/// One organ, drawn by organ.surface and by the reference from the same mesh and the same inputs.
class OrganStage {
  public:
    OrganStage(int width, int height);

    TempFolder folder;
    nlohmann::json parameters;  ///< of the pass; "mesh" is filled in
    nlohmann::json camera;
    reference::Organ organ;  ///< all but mesh, view and what targets hold
    int width;
    int height;

    void use_mesh(const std::string& obj);
    /// A picture file (rgba32f EXR), and the same for the reference.
    std::string picture_file(const std::string& name, int size,
                             const std::function<float(double u, double v, int c)>& f);
    [[nodiscard]] static Image picture(int size, const std::function<float(double u, double v, int c)>& f);
    /// A target that another pass fills, all four channels.
    void target(const std::string& name, int size, const std::function<float(double u, double v, int c)>& f);

    /// Scene with what has been set.
    [[nodiscard]] nlohmann::json scene() const;
    /// Draws into rgba32f and reads it.
    Image render(double time_s = 0.0, const HostValues* values = nullptr);
    /// A filled target as the pass read it.
    [[nodiscard]] reference::OrganMap read_target(const std::string& name);
    /// The reference's picture, over the target's clear value. With the mesh's placement, if there is one.
    [[nodiscard]] reference::Buffer expected();
    [[nodiscard]] Stage& stage() { return stage_; }
    [[nodiscard]] const FrameReport& report() const { return report_; }

  private:
    void slant(Frame& frame) const;
    void place(const MeshData& mesh);
    struct Filled {
        std::string target;
        std::string file;
        int size = 0;
    };
    std::string mesh_file_;
    std::vector<Filled> filled_;
    Stage stage_;
    FrameReport report_;
};

}  // namespace viscera::test
