#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "effects/organ/organ_params.h"
#include "engine/core/camera.h"
#include "engine/core/log.h"
#include "engine/gl/program.h"
#include "engine/gl/texture.h"
#include "engine/runtime/frame.h"

namespace viscera {
class Pass;
}

namespace viscera::organ {

/// As many spots as a frame can show: software renderers end all loops of a pixel after 65,535 turns.
inline constexpr std::size_t most_spots = 60000;

/// Bruises of this frame.
class Hematoma {
  public:
    /// Gathers the spots of the scene and the host. Spots that are not finite or have no size count as
    /// faults, those beyond most_spots are left out with one.
    void gather(const HematomaParams& params, const HostValues* values, Log& log);

    [[nodiscard]] bool empty() const { return spots_.empty(); }
    [[nodiscard]] std::size_t count() const { return spots_.size(); }
    /// Changes whenever the host's spots do.
    [[nodiscard]] std::uint64_t key() const { return key_; }

    /// Spots in the frame that the shader measures in: world spots in the eye's axes, counted from the
    /// organ's centre. Each is listed in the cells of the picture, or of texture space, that it may touch.
    void set(const Pass& pass, const gl::Program& program, const HematomaParams& params, const View& view,
             const glm::dvec3& centre_in_eye);

  private:
    /// The cells that a spot may touch, the last ones included.
    struct Range {
        glm::ivec2 first{0};
        glm::ivec2 last{-1};
        [[nodiscard]] std::size_t count() const {
            const glm::ivec2 cells = glm::max(last - first + 1, 0);
            return static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y);
        }
    };
    void find_ranges(const HematomaParams& params, const View& view, glm::ivec2 size);
    void sort_into_cells(std::span<const glm::vec4> shader_spots);

    std::vector<glm::dvec4> spots_;  ///< centre, radius
    glm::ivec2 cells_{1};            ///< along x and y
    glm::dvec2 cells_per_unit_{1.0};
    std::vector<Range> ranges_;            ///< by spot
    std::vector<glm::vec4> shader_spots_;  ///< by spot
    std::vector<std::uint32_t> next_;      ///< by cell
    std::vector<glm::vec2> cell_texels_;
    std::vector<glm::vec4> texels_;
    std::optional<gl::Texture> cell_texture_;
    std::optional<gl::Texture> texture_;
    std::uint64_t key_ = 0;
};

}  // namespace viscera::organ
