#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "effects/contrast/arrival_time.h"
#include "effects/contrast/flow_network.h"
#include "effects/contrast/geodesic.h"
#include "engine/core/mesh_data.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/frame.h"
#include "engine/runtime/mesh_file.h"

namespace viscera::contrast {

/// Where the density comes from (spec: section "where the density comes from").
enum class DensitySource { arrival_time, per_vertex };
[[nodiscard]] std::span<const std::string_view> choice_names(DensitySource source);

/// A vessel surface and how contrast gets into it.
struct VesselParams {
    MeshFile mesh;
    DensitySource density = DensitySource::arrival_time;
    std::string scalar = "DENSITY";
    AssetPath centreline;
    double full_calibre_mm = 0.0;
    int smoothing_rounds = 2;
    std::optional<glm::dvec3> injection_mm;
    FlowParams flow;
    GeodesicParams geodesic;

    void visit(ParamVisitor& v);
};

/// A vessel surface in memory, with one float per vertex: arrival time [s] or density.
struct Vessel {
    MeshData mesh;
    Bounds bounds;
    std::vector<float> scalar;
    /// Share of the bolus's density that shows, by the vessel's calibre; empty: all of it everywhere.
    std::vector<float> weight;
    VertexTubes tubes;  ///< with a centreline: the vessel around each vertex
    float first_arrival_s =
        0.0F;  ///< over the vertices that contrast reaches; first > last where it reaches none
    float last_arrival_s = -1.0F;
    glm::dvec3 injection_mm{0.0};  ///< given, or the vertex at which contrast arrives first
};

/// Reads the mesh and finds the arrival time of each vertex, once for all passes that give the same
/// parameters. Throws Error.
[[nodiscard]] std::shared_ptr<const Vessel> load_vessel(Assets& assets, const VesselParams& params);

}  // namespace viscera::contrast
