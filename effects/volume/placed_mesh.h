#pragma once

#include "effects/volume/source.h"
#include "engine/runtime/mesh_file.h"

namespace viscera::volume {

/// A surface from a file, put somewhere in the volume's world.
struct PlacedMesh : MeshFile {
    PlacementParams placement;

    /// `file_key` and `doc` are those of the file, which may be left out.
    void visit(ParamVisitor& v, std::string_view file_key, std::string_view doc);
    [[nodiscard]] bool empty() const { return file.empty(); }
    /// Its triangles in local coordinates. Throws Error(file).
    [[nodiscard]] MeshData in_local(const glm::dmat4& local_to_world, Log& log) const;
};

}  // namespace viscera::volume
