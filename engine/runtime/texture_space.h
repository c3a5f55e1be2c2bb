#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/mesh_data.h"

namespace viscera {

class Assets;

/// Whose texture coordinates a surface is painted by.
enum class AtlasSource {
    automatic,  ///< the file's where each place has its own, else made ones
    file,
    generated,
};
[[nodiscard]] std::span<const std::string_view> choice_names(AtlasSource);

/// A mesh with coordinates that give each of its points a place of its own in a texture.
struct TextureSpace {
    MeshData mesh;                       ///< vertices that charts share are repeated at the end
    std::vector<glm::vec2> picture_uvs;  ///< what the file's pictures are made for, one per vertex
    std::vector<std::uint32_t> origin;   ///< per vertex after the file's: which of these it repeats
};

/// Finds or makes them for the meshes of one file, in their order. Says in the log what it made and why. Made
/// atlases are kept in the disk cache. `where` names the file.
[[nodiscard]] TextureSpace make_texture_space(std::span<const MeshData> parts, AtlasSource source,
                                              const std::string& where, Assets& assets);

}  // namespace viscera
