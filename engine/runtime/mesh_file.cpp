#include "engine/runtime/mesh_file.h"

#include "engine/core/hash.h"
#include "engine/io/mesh.h"
#include "engine/runtime/assets.h"

namespace viscera {

void MeshFile::visit(ParamVisitor& v, const MeshFileNames& names) {
    v.field({.name = names.file, .doc = names.doc, .required = names.required}, file);
    v.field({.name = names.filter, .doc = "Only meshes whose name contains this; empty: all."}, filter);
    v.field({.name = "mm_per_unit",
             .doc = "Length of the file's unit; by default 1000 for glTF, 1 for the others.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            mm_per_unit);
}

std::uint64_t MeshFile::key(Assets& assets) const {
    return Hash().add(assets.file_key(file.path)).add(filter).add(mm_per_unit.value_or(0.0)).value();
}

std::vector<MeshData> MeshFile::load(Log& log) const {
    return io::load_meshes(file.path, {.scale_mm_per_unit = mm_per_unit, .name_filter = filter}, log);
}

MeshData MeshFile::load_merged(Log& log) const {
    return io::merge(load(log));
}

}  // namespace viscera
