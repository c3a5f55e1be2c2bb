#pragma once

#include <optional>
#include <vector>

#include "effects/contrast/bolus.h"
#include "effects/contrast/geometry_params.h"
#include "effects/contrast/painter_order.h"
#include "effects/contrast/vessel.h"
#include "engine/runtime/effect.h"

namespace viscera::contrast {

struct GpuVessel;

/// Draws the vessel surface into any of contrast.main, contrast.cloud and contrast.distance in one pass.
class GeometryEffect final : public Effect {
  public:
    /// Which of the three the effect makes.
    struct Outputs {
        bool main = true;
        bool cloud = true;
        bool distance = true;
    };

    explicit GeometryEffect(Outputs outputs);

    void visit(ParamVisitor& visitor) override;
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    enum class Scalar { none, density, arrival, arrival_table };
    struct Variant {
        Scalar scalar = Scalar::none;
        bool cloud = false;
        bool distance = false;
        bool depth = false;
        bool calibre = false;
        bool thickness = false;
        bool operator==(const Variant&) const = default;
    };

    void list_variants();
    [[nodiscard]] std::uint32_t port_bit(std::string_view port) const;
    bool update_density(Prepare& prepare);
    [[nodiscard]] bool makes_density(double since_start_s) const;
    [[nodiscard]] glm::dvec3 cloud_centre() const;
    [[nodiscard]] Bounds cloud_bounds() const;
    void sort_triangles(GpuVessel& gpu);

    Outputs outputs_;
    GeometryParams params_;
    std::vector<Variant> variants_;
    std::vector<ProgramDesc> programs_;

    std::uint64_t parameters_key_ = 0;
    std::uint32_t main_bits_ = 0;  ///< places in ports(): of main and its depth
    std::uint32_t cloud_bit_ = 0;
    std::uint32_t distance_bit_ = 0;
    std::optional<Bolus> bolus_;
    std::uint64_t bolus_table_key_ = 0;
    std::shared_ptr<const Vessel> vessel_;
    std::vector<float> host_density_;
    std::uint64_t host_version_ = 0;
    float densest_ = 0.0F;  ///< per_vertex: the largest density

    // of the frame in preparation
    Variant variant_;
    double since_start_s_ = 0.0;
    double brightness_ = 0.0;

    TriangleOrderScratch scratch_;
    std::vector<float> vertex_density_;
    std::vector<std::uint32_t> sorted_;
};

}  // namespace viscera::contrast
