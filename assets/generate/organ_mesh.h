#pragma once

#include <cstdint>

#include "assets/generate/organ_field.h"
#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// What the organ's scenes, pictures and tests are made with [mm].
inline constexpr double organ_spacing_mm = 4.4;

/// The smallest cosine between a triangle and the field's normals at its corners. Near or below 0 the grid
/// has missed something thin: triangles fold over.
[[nodiscard]] double least_agreement(const MeshData& mesh);

/// The body's surface with outward normals and an atlas of planar charts: the zero surface of the field on a
/// grid of the given spacing, or a somewhat finer one where that misses something, vertices spread evenly.
/// Vertices at the borders of charts come once per chart. Throws std::runtime_error when no grid gives one
/// closed surface without folds.
[[nodiscard]] MeshData mesh_organ(const OrganField& field, double spacing_mm);

/// The wall of the abdomen around it, open towards the navel: seen from inside, one chart.
[[nodiscard]] MeshData mesh_abdomen(std::uint64_t seed, int cells);

}  // namespace viscera::assets
