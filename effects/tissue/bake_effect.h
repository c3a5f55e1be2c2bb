#pragma once

#include <memory>
#include <vector>

#include "effects/tissue/baked_surface.h"

namespace viscera::tissue {

struct BakeParams {
    SurfaceMeshParams mesh;
    int size = 512;

    void visit(ParamVisitor& v);
};

/// A surface in texture space: where each texel lies in the world, its normal and scale, and where the
/// surface goes on beyond the border of a chart.
class BakeEffect final : public Effect {
  public:
    BakeEffect();
    ~BakeEffect() override;
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    struct Gpu;
    void find_map(Prepare& prepare);
    void fill_vertices();
    void count_collapsed(Log& log);
    void upload(const Pass& pass);

    BakeParams params_;
    std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<BakedSurface> surface_;
    std::shared_ptr<const void> baker_;  ///< by which the surface knows that it is baked
    std::shared_ptr<const TexelMap> map_;
    std::uint64_t content_key_ = 0;
    std::uint64_t counted_shape_ = 0;  ///< in which collapsed triangles were counted
    std::uint32_t wanted_ = 0;         ///< bit i: feature i is read by somebody
    std::vector<glm::vec4> vertices_;  ///< two per vertex: world position and u, world normal and v
    std::unique_ptr<Gpu> gpu_;
};

}  // namespace viscera::tissue
