#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "effects/volume/placed_mesh.h"
#include "effects/volume/ray_cast_params.h"
#include "effects/volume/space.h"
#include "engine/core/mesh_data.h"
#include "engine/runtime/effect.h"

namespace viscera::volume {

struct LimitsParams {
    SourceParams volume;
    CropParams crop;
    PlacedMesh mesh;

    void visit(ParamVisitor& v);
};

/// The box as 12 triangles that face outwards.
[[nodiscard]] MeshData box_mesh(const glm::vec3& low, const glm::vec3& high);
/// Six times the volume enclosed by a closed mesh; negative when its triangles face inwards.
[[nodiscard]] double signed_volume6(const MeshData& mesh);

/// Draws where rays enter a volume, or leave it, as pictures of local coordinates: the faces of its box, or
/// of a closed mesh. Of several faces behind one another the nearest entry and the farthest exit are kept;
/// the inner ones tell apart two passages through a mesh that is not convex.
class LimitsEffect final : public Effect {
  public:
    /// inner_exit: where rays leave for the first time; inner_entry: where they enter for the last time.
    enum class Side { entry, exit, inner_entry, inner_exit };
    explicit LimitsEffect(Side side);

    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    void find_mesh(Prepare& prepare);
    [[nodiscard]] bool leaves() const { return side_ == Side::exit || side_ == Side::inner_exit; }
    /// Whether the farthest face is kept, not the nearest.
    [[nodiscard]] bool farthest() const { return side_ == Side::exit || side_ == Side::inner_entry; }

    Side side_;
    std::vector<ProgramDesc> programs_;
    LimitsParams params_;
    std::uint64_t parameters_key_ = 0;
    std::uint64_t mesh_key_ = 0;
    VolumeGrid grid_;
    Space space_;
    MeshData mesh_;
    Bounds bounds_;
    bool inside_out_ = false;
};

}  // namespace viscera::volume
