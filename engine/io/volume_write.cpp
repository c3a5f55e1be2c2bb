#include "engine/core/error.h"
#include "engine/io/volume.h"
namespace viscera::io {
void write_volume(const Volume& volume, const std::filesystem::path& file) {
    volume.validate();
    throw Error(ErrorCode::file, file.string(), "");
}
}  // namespace viscera::io
