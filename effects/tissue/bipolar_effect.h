#pragma once

#include <memory>
#include <vector>

#include "effects/tissue/baked_surface.h"
#include "effects/tissue/held_triangles.h"

namespace viscera::tissue {

enum class ToolShape { capsule, box, sphere, cylinder };
[[nodiscard]] std::span<const std::string_view> choice_names(ToolShape shape);

/// The space between the jaws of a bipolar tool, in the tool's own frame, centred at its origin.
struct ToolParams {
    ToolShape shape = ToolShape::capsule;
    glm::dvec3 size_mm{8.0, 3.0, 2.0};
    PlacementParams placement;

    void visit(ParamVisitor& v);
};

struct BipolarParams {
    SurfaceMeshParams mesh;
    int size = 512;
    std::vector<int> held;
    ToolParams tool;
    double energy = 1.0;
    double max_uv_perimeter = 0.15;

    void visit(ParamVisitor& v);
};

/// Tissue that a bipolar tool holds: burnt where it lies within the tool's shape.
class BipolarEffect final : public Effect {
  public:
    BipolarEffect();
    ~BipolarEffect() override;
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    struct Gpu;
    void find_surface(Prepare& prepare);
    bool find_tool(Prepare& prepare);
    [[nodiscard]] std::span<const float> held_numbers(const HostValues* values);

    BipolarParams params_;
    std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<BakedSurface> surface_;
    std::shared_ptr<const TexelMap> map_;
    std::unique_ptr<HeldTriangles> triangles_;
    std::vector<float> held_;  ///< numbers of the parameters
    glm::dmat4 pose_{1.0};
    std::vector<std::uint32_t> found_;
    std::unique_ptr<Gpu> gpu_;
};

}  // namespace viscera::tissue
