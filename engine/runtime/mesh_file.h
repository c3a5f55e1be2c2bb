#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/mesh_data.h"
#include "engine/core/params.h"

namespace viscera {

class Log;

/// Which meshes of which file, and how long the file's unit is. The fields stand among those of the
/// parameters that have such a file.
struct MeshFile {
    AssetPath file;
    std::string filter;
    std::optional<double> mm_per_unit;

    /// The keys of `file` and `filter`; the third's is `mm_per_unit`.
    void visit(ParamVisitor& v, std::string_view file_key = "mesh",
               std::string_view filter_key = "mesh_filter");
    /// Hash of all of it.
    [[nodiscard]] std::uint64_t key() const;
    /// The file's meshes, apart or as one. Throws as io::load_meshes().
    [[nodiscard]] std::vector<MeshData> load(Log& log) const;
    [[nodiscard]] MeshData load_merged(Log& log) const;
};

}  // namespace viscera
