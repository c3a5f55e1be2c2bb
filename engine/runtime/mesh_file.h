#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/mesh_data.h"
#include "engine/core/params.h"

namespace viscera {

class Assets;
class Log;

/// How the fields of a MeshFile are called among other parameters; the third's key is `mm_per_unit`.
struct MeshFileNames {
    std::string_view file = "mesh";
    std::string_view filter = "mesh_filter";
    std::string_view doc = "Surface: glTF, GLB, STL, OBJ, PLY or VTP.";  ///< of the file
    bool required = true;                                                ///< whether a file must be named
};

/// Which meshes of which file, and how long the file's unit is. The fields stand among those of the
/// parameters that have such a file.
struct MeshFile {
    AssetPath file;
    std::string filter;
    std::optional<double> mm_per_unit;

    void visit(ParamVisitor& v, const MeshFileNames& names = {});
    /// Hash of all of it, and of the file as `assets` know it.
    [[nodiscard]] std::uint64_t key(Assets& assets) const;
    /// The file's meshes, apart or as one. Throws as io::load_meshes().
    [[nodiscard]] std::vector<MeshData> load(Log& log) const;
    [[nodiscard]] MeshData load_merged(Log& log) const;
};

}  // namespace viscera
