#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace viscera::io {

/// A glTF file whose every reference has been checked: what it names exists, what it counts fits.
struct GltfFile {
    /// Only what geometry needs: asset, scene, scenes, nodes, meshes, accessors, bufferViews, buffers. The
    /// uri of buffer i is "i".
    nlohmann::json document;
    std::vector<std::string> buffers;  ///< the bytes of each buffer, byteLength of them
    std::size_t posed = 0;  ///< nodes with a skin and primitives with morph targets: their poses are left out
};

/// Reads .gltf or .glb (told apart by content) with its buffers: the binary chunk, data URIs, and files
/// inside the folder of `file`. Throws Error(file) that names the JSON pointer at fault: references and byte
/// ranges out of range, nodes in a cycle or with two parents, URIs that leave the folder, extensions that
/// cannot be done without.
[[nodiscard]] GltfFile read_gltf_file(const std::filesystem::path& file);

/// Throws std::runtime_error with the JSON pointer where geometry does not hold. `buffer_bytes`: byteLength
/// of each buffer.
void check_gltf(const nlohmann::json& document, const std::vector<std::size_t>& buffer_bytes);

}  // namespace viscera::io
