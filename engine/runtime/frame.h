#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/eyes.h"
#include "engine/core/pixel_format.h"
#include "engine/core/pixel_rect.h"
#include "engine/core/volume.h"
#include "engine/runtime/quality.h"

namespace viscera {

/// What a host tells effects while frames go by: arrays of floats by name (per-vertex densities, emitters,
/// contacts). A changed array has another version, so that effects know when to redraw.
class HostValues {
  public:
    struct Entry {
        std::vector<float> values;
        std::uint64_t version = 0;  ///< hash of the values, never 0
    };

    /// Replaces an array. Allocation-free when the size does not grow.
    void set(std::string_view name, std::span<const float> values);
    /// Removes an array; unknown names are ignored.
    void erase(std::string_view name);
    /// The array of a name, or null.
    [[nodiscard]] const Entry* find(std::string_view name) const;

  private:
    std::map<std::string, Entry, std::less<>> entries_;
};

/// A texture of the host that stands for a target of the scene. It is never deleted by viscera. Frames with
/// one that is no 2-D texture, of another size, or depth where colour is said (or the other way round) are
/// refused.
struct ImportedTexture {
    std::string target;
    unsigned texture = 0;  ///< OpenGL name of a GL_TEXTURE_2D
    PixelFormat format = PixelFormat::rgba8;
    int width = 0;
    int height = 0;
    bool writable = false;
    std::uint64_t version =
        0;  ///< changed by the host whenever the content has changed; 0: changes every frame
};

/// A volume that the host shows and changes, known to scenes by its name.
struct HostVolume {
    std::string_view name;
    const LiveVolume* volume = nullptr;
};

/// Who puts OpenGL state back after a frame.
enum class HostStatePolicy {
    restore,      ///< viscera saves and restores every state row it may touch
    host_resets,  ///< the host sets its own state anew; saves the cost of the queries
};

/// Where the picture goes besides its target. The framebuffer is the caller's own; 0 only when the caller
/// says so.
struct Present {
    bool enabled = false;
    std::string output;        ///< which output; empty: the scene's first
    unsigned framebuffer = 0;  ///< OpenGL name
    PixelRect viewport;        ///< [pixels] of that framebuffer
    bool flip_y = false;
};

/// Everything that one frame depends on besides the scene.
struct Frame {
    int width = 0;   ///< [pixels]
    int height = 0;  ///< [pixels]
    std::uint64_t index = 0;
    double time_s = 0.0;
    std::array<View, 2> eyes{};
    int eye_count = 1;  ///< 1, or 2 (left, right); width and height are those of one eye's picture
    /// Effects are given frames of one eye; this says which: 0 the left or only one, 1 the right.
    int eye_index = 0;
    const HostValues* values = nullptr;  ///< null: the scene's timeline stands in
    std::span<const ImportedTexture> imported;
    std::span<const HostVolume> volumes;
    Quality quality{};
    /// With two eyes: both side by side, the left one in the left half of the viewport; an output named
    /// NAME.left or NAME.right alone.
    Present present;
    Present present_right;  ///< of the right eye alone, when enabled; `present` then shows the left one
    bool capture = true;    ///< whether what the renderer dumps is read back from this frame
    HostStatePolicy host_state = HostStatePolicy::restore;

    void look(const Eyes& through) {
        eyes = through.views;
        eye_count = through.count;
    }
    [[nodiscard]] const View& eye() const {
        assert(eye_count > 0 && "an effect whose uses_view() is false looks at the view");
        return eyes[0];
    }
    [[nodiscard]] double aspect() const { return static_cast<double>(width) / static_cast<double>(height); }
};

/// Throws Error(usage) for a frame that no scene could be rendered for.
void check_frame(const Frame& frame);

}  // namespace viscera
