#pragma once

#include <cstdint>
#include <memory>

#include "effects/contrast/vessel.h"
#include "engine/gl/mesh.h"

namespace viscera::contrast {

/// A vessel on the GPU, shared by all passes that draw it. Its attributes, as glsl/contrast/geometry.vert
/// reads them: scalar the arrival time or density; with a centreline also uv.x the weight of its calibre,
/// uv.y and picture_uv the axis, normal the way from the axis to the vertex [mm].
struct GpuVessel {
    GpuVessel(const gl::Functions& gl, std::shared_ptr<const Vessel> drawn);

    std::shared_ptr<const Vessel> vessel;  ///< known by its address, which thus stays its own
    gl::Mesh mesh;
    std::uint64_t host_version = 0;  ///< of the host's densities that it holds; 0: the vessel's own
};

}  // namespace viscera::contrast
