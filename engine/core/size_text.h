#pragma once

#include <string>

#include <glm/glm.hpp>

namespace viscera {

/// "640 x 480": how messages give the size of a picture.
[[nodiscard]] inline std::string size_text(const glm::ivec2& size) {
    return std::to_string(size.x) + " x " + std::to_string(size.y);
}

/// The same of a volume: "256 x 256 x 100".
[[nodiscard]] inline std::string size_text(const glm::ivec3& size) {
    return size_text(glm::ivec2(size)) + " x " + std::to_string(size.z);
}

}  // namespace viscera
