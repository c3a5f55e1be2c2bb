#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/pixel_format.h"

namespace viscera {

/// How a pass touches a target.
enum class Access {
    read,      ///< samples the nearest write of the name above
    write,     ///< gives the name wholly new content
    modify,    ///< blends or depth-tests into the nearest write above
    previous,  ///< samples what the name held at the end of the last frame
};

[[nodiscard]] std::string_view to_string(Access access);
/// Whether a pass draws into the target.
[[nodiscard]] constexpr bool makes_content(Access access) {
    return access == Access::write || access == Access::modify;
}

/// Size of a target: a fraction of the frame, or absolute when width and height are > 0.
struct SizeRule {
    double scale = 1.0;  ///< of the frame's width and height, in (0, 4]
    int width = 0;       ///< [pixels]
    int height = 0;      ///< [pixels]
    int columns = 1;     ///< pictures side by side: the width found by the above, so many times
    bool operator==(const SizeRule&) const = default;
};

/// Whether a target may be called so: lower-case letters, digits and '_', in words joined by dots, at most
/// 128 characters. Files are named after targets, so nothing else may pass.
[[nodiscard]] bool is_target_name(std::string_view name);

/// What a named target is made of. A name that several passes write has one description.
struct TargetDesc {
    std::string name;  ///< dotted lower-case words: "contrast.main"
    PixelFormat format = PixelFormat::rgba16f;
    SizeRule size;
    std::array<float, 4> clear{0.0F, 0.0F, 0.0F, 0.0F};
};

/// One port of a pass bound to a target.
struct GraphPort {
    std::string port;    ///< the effect's own word: "main"
    std::string target;  ///< the target's name: "contrast.main"
    Access access = Access::read;
    bool optional = false;  ///< a read without a writer above is then no fault: the input is empty
    /// For a write: the read or `previous` port whose content stands in for this output in a frame in which
    /// the pass has nothing to do, without a copy. Empty: the output then holds its clear value.
    std::string passthrough;
};

struct GraphPass {
    std::string name;  ///< unique in the graph
    std::string effect;
    bool enabled = true;
    std::vector<GraphPort> ports;
};

/// A texture that the host brings; it exists before the first pass.
struct ImportedTarget {
    std::string name;
    PixelFormat format = PixelFormat::rgba8;
    int width = 0;   ///< [pixels]
    int height = 0;  ///< [pixels]
    bool writable = false;
};

/// Passes in the order they run, over named targets. No edges: a read of `x` means the nearest write of `x`
/// above.
struct Graph {
    std::vector<TargetDesc> targets;
    std::vector<ImportedTarget> imported;
    std::vector<GraphPass> passes;
    std::vector<std::string> outputs;  ///< names wanted at the end of the frame
};

}  // namespace viscera
