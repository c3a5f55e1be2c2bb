#pragma once

#include <filesystem>
#include <string_view>

#include "assets/generate/coronary.h"
#include "assets/generate/gray_image.h"
#include "engine/core/mesh_data.h"

namespace viscera::assets {

/// Writes a whole file, making its folder if need be. Throws std::runtime_error.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// `{"unit": "mm", "nodes": [[x, y, z, radius], ...], "edges": [[from, to], ...]}`, rounded to 0.1 um.
void write_centreline(const CentrelineGraph& graph, const std::filesystem::path& path);

/// The points where a scene places a catheter's jet or a leak, as one JSON object of named vectors.
void write_landmarks(const CoronaryLandmarks& landmarks, const std::filesystem::path& path);

/// One-channel ("Y") half-float OpenEXR, ZIP compressed, top row first. Throws std::runtime_error.
void write_exr(const GrayImage& image, const std::filesystem::path& path);

}  // namespace viscera::assets
