#pragma once

#include <cstdint>
#include <filesystem>

namespace viscera::assets {

/// The seed of the assets that scenes and tests are made for.
inline constexpr std::uint64_t default_seed = 1;

/// Makes every generated asset under `folder`: meshes/, vessels/, sprites/, images/, volumes/. The same seed
/// gives the same bytes. `coarser`: volumes have that many times fewer voxels along each axis, and pictures
/// of organs fewer pixels (1, 2, 4 or 8). Throws std::runtime_error when a file cannot be written, or when a
/// vessel wall cannot be meshed soundly with this seed.
void generate_all(const std::filesystem::path& folder, std::uint64_t seed, int coarser = 1);

/// The parts of it.
void generate_vessels(const std::filesystem::path& folder, std::uint64_t seed);
void generate_sprites(const std::filesystem::path& folder, std::uint64_t seed);
void generate_images(const std::filesystem::path& folder, std::uint64_t seed);
void generate_organs(const std::filesystem::path& folder, std::uint64_t seed, int coarser = 1);
void generate_volumes(const std::filesystem::path& folder, std::uint64_t seed, int coarser = 1);

}  // namespace viscera::assets
