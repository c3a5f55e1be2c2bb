#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/runtime/surface_mesh.h"

namespace viscera::tissue {

/// How a wound bleeds.
enum class BleedingKind {
    ooze,  ///< drops well up around a place
    jet,   ///< blood leaves the vessel under pressure and flies
};
[[nodiscard]] std::span<const std::string_view> choice_names(BleedingKind);

/// A wound that bleeds.
struct WoundParams {
    glm::dvec3 position_mm{0.0};
    double radius_mm = 1.0;
    double rate_mm3_s = 20.0;
    BleedingKind kind = BleedingKind::ooze;
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double speed_mm_s = 800.0;
    double pulse_hz = 1.2;
    double pulse_depth = 0.6;
    double start_s = 0.0;
    double stop_s = 1.0e9;

    void visit(ParamVisitor& v);
};

enum class CleanerKind { suction, rinse };
[[nodiscard]] std::span<const std::string_view> choice_names(CleanerKind);

/// A tool that takes blood away.
struct CleanerParams {
    CleanerKind kind = CleanerKind::suction;
    glm::dvec3 position_mm{0.0};
    double radius_mm = 5.0;
    double rate = 500.0;
    double start_s = 0.0;
    double stop_s = 1.0e9;

    void visit(ParamVisitor& v);
};

/// What blood is like, and how finely it is followed.
struct LiquidParams {
    double viscosity_mpa_s = 4.0;
    double density_kg_m3 = 1060.0;
    double residual_mm = 0.01;
    double pinning_mm = 0.2;
    double drying_mm_s = 0.0;
    double drop_mm3 = 0.5;
    double drop_aspect = 0.35;
    double trail_mm = 0.01;
    double drop_life_s = 20.0;
    int max_drops = 16384;
    double steps_per_s = 120.0;

    void visit(ParamVisitor& v);
    [[nodiscard]] std::uint64_t key() const;
    /// Of a film under standard gravity: density times gravity over viscosity [1/(mm s)].
    [[nodiscard]] double mobility_per_mm_s() const;
};

struct BloodLookParams {
    glm::dvec3 extinction_per_mm{0.9, 24.0, 28.0};
    glm::dvec3 deep_colour{0.22, 0.008, 0.01};
    double covering_mm = 0.05;
    double bump = 1.0;

    void visit(ParamVisitor& v);
};

struct BloodParams {
    SurfaceMeshParams mesh;
    int size = 512;
    std::string state = "blood";
    LiquidParams liquid;
    BloodLookParams look;
    std::vector<WoundParams> wounds;
    std::vector<CleanerParams> tools;
    std::string host_emitters = "tissue.blood_emitters";
    std::string host_suction = "tissue.suction";
    std::string host_rinse = "tissue.rinse";
    double sealed_energy = 0.5;

    void visit(ParamVisitor& v);
};

}  // namespace viscera::tissue
