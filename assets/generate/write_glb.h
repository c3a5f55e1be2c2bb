#pragma once

#include <filesystem>

#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// Writes a mesh as binary glTF 2.0: positions in metres (file = mm / 1000) on the same axes, normals where
/// it has them, each scalar as a custom attribute of its name (which must begin with '_').
/// Throws std::runtime_error when the file cannot be written.
void write_glb(const MeshData& mesh, const std::filesystem::path& path);

}  // namespace viscera::assets
