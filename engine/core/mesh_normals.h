#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/core/mesh_data.h"

namespace viscera {

/// Gives the vertices of a place where several parts of a surface meet one normal, so that light runs across:
/// the mean of the parts', weighted by the area of their triangles there. Files whose parts were cut from one
/// surface have normals that each part made of its own triangles alone. Places stay as they are where a part
/// has several normals itself, which is an edge that is meant, or one farther than 60 degrees from the mean:
/// a corner, or sheets back to back.
/// part_vertices: how many vertices each part has, in order; place: per vertex the vertex that stands for its
/// place. Returns the number of places that were joined.
std::size_t join_normals(MeshData& mesh, std::span<const std::size_t> part_vertices,
                         std::span<const std::uint32_t> place);

}  // namespace viscera
