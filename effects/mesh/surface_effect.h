#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/mesh_data.h"
#include "engine/core/placement.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/mesh_file.h"

namespace viscera::mesh {

/// A light at infinity.
struct LightParams {
    glm::dvec3 direction{0.0, -1.0, 0.0};
    glm::dvec3 colour{1.0};

    void visit(ParamVisitor& v);
};

struct SurfaceParams {
    MeshFile mesh;
    PlacementParams placement;
    glm::dvec3 colour{0.8};
    bool two_sided = true;
    double ambient = 0.15;
    double diffuse = 0.75;
    double specular = 0.2;
    double shininess = 32.0;
    double headlight = 1.0;
    std::vector<LightParams> lights;

    void visit(ParamVisitor& v);
};

/// Draws opaque triangles, with the depth that a volume in the same picture ends at.
class SurfaceEffect final : public Effect {
  public:
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override;
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    SurfaceParams params_;
    mutable std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::uint64_t mesh_key_ = 0;
    std::shared_ptr<const MeshData> data_;
    Bounds bounds_;
    glm::dmat4 to_world_{1.0};
    std::vector<glm::vec3> light_directions_;
    std::vector<glm::vec3> light_colours_;
};

}  // namespace viscera::mesh
