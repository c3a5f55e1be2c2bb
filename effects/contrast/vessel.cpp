#include "effects/contrast/vessel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "effects/contrast/arrival_time.h"
#include "effects/contrast/density.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/params_json.h"
#include "engine/io/mesh.h"

namespace viscera::contrast {
namespace {

constexpr std::array<std::string_view, 2> source_names{"arrival_time", "per_vertex"};

void find_arrival(Vessel& vessel, const VesselParams& params, Log& log) {
    const std::vector<glm::vec3>& positions = vessel.mesh.positions;
    if (params.centreline.empty()) {
        vessel.scalar =
            geodesic_arrival(positions, vessel.mesh.indices, *params.injection_mm, params.geodesic, log);
        return;
    }
    const CentrelineGraph graph = io::load_centreline(params.centreline.path, log);
    const FlowNetwork network = solve_flow(graph, params.flow, params.injection_mm, log);
    const VertexFeet feet = vertex_feet(graph, positions);
    report_apart(graph, feet, log);
    vessel.scalar = vertex_arrival(graph, network, feet, log);
    smooth_arrival(vessel.scalar, positions, vessel.mesh.indices, params.smoothing_rounds);
    vessel.tubes = vertex_tubes(graph, feet, positions);
    if (params.full_calibre_mm > 0.0) {
        for (const glm::vec4& axis : vessel.tubes.axis) {
            vessel.weight.push_back(static_cast<float>(
                std::min(1.0, 2.0 * static_cast<double>(axis.w) / params.full_calibre_mm)));
        }
    }
}

std::vector<float> density(const Vessel& vessel, const VesselParams& params, Log& log) {
    // glTF puts an underscore before the names of attributes of one's own.
    const auto found = std::ranges::find_if(vessel.mesh.scalars, [&](const VertexScalars& scalars) {
        return scalars.name == params.scalar || scalars.name == "_" + params.scalar;
    });
    if (found == vessel.mesh.scalars.end()) {
        return std::vector<float>(vessel.mesh.positions.size(),
                                  0.0F);  // the host gives it, or there is none yet
    }
    std::vector<float> values = found->values;
    sanitise_density(values, log);
    return values;
}

void find_arrival_range(Vessel& vessel, const VesselParams& params) {
    vessel.first_arrival_s = std::numeric_limits<float>::max();
    std::size_t first = 0;
    for (std::size_t i = 0; i < vessel.scalar.size(); ++i) {
        const float tau = vessel.scalar[i];
        if (tau >= unreached_s) {
            continue;
        }
        if (tau < vessel.first_arrival_s) {
            vessel.first_arrival_s = tau;
            first = i;
        }
        vessel.last_arrival_s = std::max(vessel.last_arrival_s, tau);
    }
    if (!vessel.mesh.positions.empty()) {
        vessel.injection_mm = params.injection_mm.value_or(glm::dvec3(vessel.mesh.positions[first]));
    }
}

/// The place on the vessel that is nearest is taken, however far away it is.
void report_injection_apart(const Vessel& vessel, const VesselParams& params, Log& log) {
    const glm::dvec3 low(vessel.bounds.min);
    const glm::dvec3 high(vessel.bounds.max);
    const double distance_mm =
        glm::distance(*params.injection_mm, glm::clamp(*params.injection_mm, low, high));
    if (!vessel.bounds.empty() && distance_mm > glm::distance(low, high)) {
        log.fault("contrast.injection_apart",
                  params.mesh.file.path.string() + ": injection_mm lies " +
                      std::to_string(std::lround(std::min(distance_mm, 1e9))) +
                      " mm away from this vessel; is it in another unit or frame?");
    }
}

std::shared_ptr<Vessel> make_vessel(const VesselParams& params, Log& log) {
    auto vessel = std::make_shared<Vessel>();
    vessel->mesh = params.mesh.load_merged(log);
    vessel->bounds = vessel->mesh.bounds();
    if (vessel->mesh.indices.empty()) {
        log.fault("contrast.no_triangles",
                  params.mesh.file.path.string() + ": this vessel has no triangles; nothing is drawn of it");
    }
    if (params.density == DensitySource::arrival_time) {
        if (params.injection_mm) {
            report_injection_apart(*vessel, params, log);
        }
        find_arrival(*vessel, params, log);
        find_arrival_range(*vessel, params);
    } else {
        vessel->scalar = density(*vessel, params, log);
        vessel->injection_mm = params.injection_mm.value_or(glm::dvec3(0.0));
    }
    return vessel;
}

}  // namespace

std::span<const std::string_view> choice_names(DensitySource) {
    return source_names;
}

void VesselParams::visit(ParamVisitor& v) {
    mesh.visit(v);
    v.field(
        {.name = "density",
         .doc =
             "arrival_time: the bolus runs through the vessels; per_vertex: the mesh or the host gives it."},
        density);
    v.field({.name = "scalar",
             .doc = "per_vertex: name of the mesh's scalar (glTF attribute _NAME) or of the host's array."},
            scalar);
    v.field({.name = "centreline",
             .doc = "Centreline with radii (VTP or JSON); without one, contrast spreads over the surface."},
            centreline);
    v.field({.name = "full_calibre_mm",
             .doc = "With a centreline: vessels of this diameter or more show the bolus's whole density, "
                    "thinner ones less in proportion, as the way of the rays through them shrinks; 0: all "
                    "alike. By thickness: the way through contrast that shows as the density 1.",
             .unit = "mm",
             .min = 0.0},
            full_calibre_mm);
    v.field({.name = "smoothing_rounds",
             .doc = "With a centreline: rounds in which arrival times are evened out over the surface, for a "
                    "whole front.",
             .min = 0.0,
             .max = 100.0},
            smoothing_rounds);
    v.field({.name = "injection_mm",
             .doc = "Where contrast enters, in the mesh's frame; needed without a centreline.",
             .unit = "mm"},
            injection_mm);
    v.field({.name = "flow", .doc = "Blood flow through the centreline."}, flow);
    v.field({.name = "geodesic", .doc = "Spread over the surface, where there is no centreline."}, geodesic);
}

std::shared_ptr<const Vessel> load_vessel(Assets& assets, const VesselParams& params) {
    VesselParams copy = params;
    const std::string text = write_params([&](ParamVisitor& v) { copy.visit(v); }).dump();
    const std::uint64_t key = Hash()
                                  .add(std::string_view(text))
                                  .add(assets.file_key(params.mesh.file.path))
                                  .add(assets.file_key(params.centreline.path))
                                  .value();
    return assets.shared<Vessel>(key, [&] { return make_vessel(params, assets.log()); });
}

}  // namespace viscera::contrast
