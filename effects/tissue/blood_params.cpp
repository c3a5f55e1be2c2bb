#include "effects/tissue/blood_params.h"

#include <array>

#include "effects/tissue/gravity.h"
#include "engine/core/hash.h"

namespace viscera::tissue {

std::span<const std::string_view> choice_names(BleedingKind) {
    static constexpr std::array<std::string_view, 2> names{"ooze", "jet"};
    return names;
}

std::span<const std::string_view> choice_names(CleanerKind) {
    static constexpr std::array<std::string_view, 2> names{"suction", "rinse"};
    return names;
}

void WoundParams::visit(ParamVisitor& v) {
    v.field({.name = "position_mm",
             .doc = "Place in the world; the nearest point of the surface bleeds.",
             .unit = "mm",
             .required = true},
            position_mm);
    v.field(
        {.name = "radius_mm", .doc = "Of the place that bleeds.", .unit = "mm", .min = 0.0, .max = 1000.0},
        radius_mm);
    v.field({.name = "rate_mm3_s",
             .doc = "Volume of blood per time.",
             .unit = "mm^3/s",
             .min = 0.0,
             .max = 1.0e7},
            rate_mm3_s);
    v.field({.name = "kind", .doc = "Whether blood wells up or leaves the wound as a jet."}, kind);
    v.field({.name = "direction", .doc = "Of a jet, in the world."}, direction);
    v.field({.name = "speed_mm_s",
             .doc = "Mean speed at which a jet leaves the wound.",
             .unit = "mm/s",
             .min = 0.0,
             .max = 1.0e5},
            speed_mm_s);
    v.field({.name = "pulse_hz",
             .doc = "Of the heart, for a jet; 0: it does not pulse.",
             .unit = "Hz",
             .min = 0.0,
             .max = 10.0},
            pulse_hz);
    v.field({.name = "pulse_depth", .doc = "Share of speed and rate that pulses.", .min = 0.0, .max = 1.0},
            pulse_depth);
    v.field({.name = "start_s", .doc = "Bleeds from this time on.", .unit = "s"}, start_s);
    v.field({.name = "stop_s", .doc = "Until this time.", .unit = "s"}, stop_s);
}

void CleanerParams::visit(ParamVisitor& v) {
    v.field({.name = "kind", .doc = "What it does."}, kind);
    v.field({.name = "position_mm", .doc = "Of its tip, in the world.", .unit = "mm", .required = true},
            position_mm);
    v.field({.name = "radius_mm",
             .doc = "How far from its tip it works.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            radius_mm);
    v.field(
        {.name = "rate",
         .doc =
             "Suction: the most that it takes [mm^3/s]; rinse: share of what is there that it takes [1/s].",
         .min = 0.0},
        rate);
    v.field({.name = "start_s", .doc = "Works from this time on.", .unit = "s"}, start_s);
    v.field({.name = "stop_s", .doc = "Until this time.", .unit = "s"}, stop_s);
}

void LiquidParams::visit(ParamVisitor& v) {
    v.field({.name = "viscosity_mpa_s", .doc = "Of the blood.", .unit = "mPa s", .min = 0.1, .max = 1.0e6},
            viscosity_mpa_s);
    v.field({.name = "density_kg_m3", .doc = "Of the blood.", .unit = "kg/m^3", .min = 1.0, .max = 1.0e5},
            density_kg_m3);
    v.field({.name = "residual_mm",
             .doc = "Thickness of a film that no longer flows.",
             .unit = "mm",
             .min = 0.0,
             .max = 10.0},
            residual_mm);
    v.field({.name = "pinning_mm",
             .doc = "Height over the residual film from which on the edge of a film spreads over dry tissue.",
             .unit = "mm",
             .min = 0.0,
             .max = 10.0},
            pinning_mm);
    v.field({.name = "drying_mm_s",
             .doc = "Thickness that dries per time.",
             .unit = "mm/s",
             .min = 0.0,
             .max = 10.0},
            drying_mm_s);
    v.field({.name = "drop_mm3",
             .doc = "Volume of a new drop.",
             .unit = "mm^3",
             .min = 0.0,
             .max = 1000.0,
             .min_excluded = true},
            drop_mm3);
    v.field({.name = "drop_aspect",
             .doc = "Height of a drop over the radius of its foot.",
             .min = 0.05,
             .max = 2.0},
            drop_aspect);
    v.field({.name = "trail_mm",
             .doc = "Thickness of the film that a drop leaves behind.",
             .unit = "mm",
             .min = 0.0,
             .max = 1.0},
            trail_mm);
    v.field({.name = "drop_life_s",
             .doc = "Age at which a drop becomes film.",
             .unit = "s",
             .min = 0.0,
             .max = 600.0},
            drop_life_s);
    v.field({.name = "max_drops",
             .doc = "Drops at a time; where more come, the oldest become film.",
             .min = 256,
             .max = 1048576},
            max_drops);
    v.field({.name = "steps_per_s",
             .doc = "Steps of the simulation, on a grid of times that no frame rate shifts.",
             .unit = "1/s",
             .min = 15.0,
             .max = 10000.0},
            steps_per_s);
}

std::uint64_t LiquidParams::key() const {
    return Hash()
        .add(viscosity_mpa_s)
        .add(density_kg_m3)
        .add(residual_mm)
        .add(pinning_mm)
        .add(drying_mm_s)
        .add(drop_mm3)
        .add(drop_aspect)
        .add(trail_mm)
        .add(drop_life_s)
        .value();
}

double LiquidParams::mobility_per_mm_s() const {
    // kg/m^3 m/s^2 / (Pa s) is 1/(m s).
    return density_kg_m3 * standard_gravity_m_s2 / (viscosity_mpa_s * 1e-3) * 1e-3;
}

void BloodLookParams::visit(ParamVisitor& v) {
    v.field({.name = "extinction_per_mm",
             .doc = "Of red, green and blue light on its way through blood and back.",
             .unit = "1/mm",
             .min = 0.0,
             .max = 1.0e4},
            extinction_per_mm);
    v.field(
        {.name = "deep_colour", .doc = "Red, green and blue of a layer without end.", .min = 0.0, .max = 1.0},
        deep_colour);
    v.field({.name = "covering_mm",
             .doc = "Thickness at which 63 % of the tissue's own shine is covered.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            covering_mm);
    v.field({.name = "bump", .doc = "Scale of the slopes in the normal.", .min = 0.0, .max = 100.0}, bump);
}

void BloodParams::visit(ParamVisitor& v) {
    v.field({.name = "mesh", .doc = "The surface, as the bake's.", .required = true}, mesh);
    v.field({.name = "size",
             .doc = "Texels along each side, as the bake's.",
             .unit = "px",
             .min = 16,
             .max = 4096},
            size);
    v.field({.name = "state", .doc = "Name of the blood; passes with the same name show the same."}, state);
    v.field({.name = "liquid", .doc = "What blood is like."}, liquid);
    v.field({.name = "look", .doc = "What it looks like."}, look);
    v.field({.name = "wounds", .doc = "Places that bleed, at most 65536 with the host's."}, wounds);
    v.field({.name = "tools", .doc = "Suction and rinsing, at most 16 with the host's."}, tools);
    v.field(
        {.name = "host_emitters", .doc = "Name of the host's array of wounds, 12 floats each; empty: none."},
        host_emitters);
    v.field(
        {.name = "host_suction", .doc = "Name of the host's array of suction, 5 floats each; empty: none."},
        host_suction);
    v.field({.name = "host_rinse", .doc = "Name of the host's array of rinsing, 5 floats each; empty: none."},
            host_rinse);
    v.field({.name = "sealed_energy",
             .doc = "Energy at which coagulated tissue no longer bleeds; it bleeds less from half of it on.",
             .min = 0.0,
             .min_excluded = true},
            sealed_energy);
}

}  // namespace viscera::tissue
