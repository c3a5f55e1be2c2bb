#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/graph.h"

namespace viscera {

/// One thing wrong with a graph. Fields that do not apply are empty.
struct Fault {
    std::string pass;
    std::string port;
    std::string target;
    std::string message;
    bool limit = false;  ///< nothing is wrong but the size, which the device cannot take
};

/// "pass 'p', port 'q', target 't': message"
[[nodiscard]] std::string to_string(const Fault& fault);

/// What a name holds between one write and the next: the unit of lifetime. A pass that reads and writes one
/// name reads one content and makes another (ping-pong); `modify` makes a new content in the same texture.
struct PlanContent {
    std::string target;
    PixelFormat format = PixelFormat::rgba16f;
    int width = 0;   ///< [pixels]
    int height = 0;  ///< [pixels]
    std::array<float, 4> clear{};
    std::optional<std::size_t>
        writer;  ///< index of the pass; none when imported or brought from the last frame
    std::optional<std::size_t> modifies;     ///< index of the content that this one continues
    std::optional<std::size_t> passthrough;  ///< index of the content that stands in when the writer is idle
    std::optional<std::size_t> texture;      ///< index into Plan::textures; none when imported or culled
    std::optional<std::size_t> imported;     ///< index into Graph::imported
    std::size_t first_pass = 0;              ///< lifetime, in pass indices, both ends included
    std::size_t last_pass = 0;               ///< passes.size() when it is an output or history
};

/// A texture object that contents share by turns.
struct PlanTexture {
    PixelFormat format = PixelFormat::rgba16f;
    int width = 0;
    int height = 0;
};

struct PlanBinding {
    std::string port;
    Access access = Access::read;
    /// The content sampled (read, previous) or drawn into (write, modify: the new content). None: an optional
    /// read that nothing writes, or a write (not of depth) that nobody needs.
    std::optional<std::size_t> content;
};

struct PlanPass {
    std::string name;
    std::string effect;
    bool live = false;
    std::string
        reason;  ///< "writes output 'final'", "read by 'summarize'", "culled: no output needs it", "disabled"
    std::vector<PlanBinding> bindings;
};

/// A name whose content outlives the frame, because some pass reads `previous`. The executor keeps two
/// textures and swaps.
struct PlanHistory {
    std::string target;
    std::size_t previous = 0;            ///< content that `previous` reads see
    std::optional<std::size_t> current;  ///< content at the end of the frame; none: the name is never written
};

struct PlanOutput {
    std::string target;
    std::size_t content = 0;
};

/// What compile() makes of a graph: what runs, in which textures, and why.
struct Plan {
    int width = 0;
    int height = 0;
    std::vector<PlanPass> passes;  ///< as many and in the same order as Graph::passes
    std::vector<PlanContent> contents;
    std::vector<PlanTexture> textures;
    std::vector<PlanHistory> history;
    std::vector<PlanOutput> outputs;
};

struct CompileResult {
    Plan plan;                  ///< meaningful only when faults is empty
    std::vector<Fault> faults;  ///< every fault of the graph, in the order of its passes
};

/// Resolves names, culls what no output needs, and shares textures by lifetime. Pure: no GL, no I/O.
/// `width`, `height`: the frame [pixels], >= 1; `max_size`: the device's limit for a 2-D texture [pixels].
[[nodiscard]] CompileResult compile(const Graph& graph, int width, int height, int max_size = 16384);

/// As compile(), but throws Error(scene) that lists every fault, one a line; Error(limit) when all that is
/// wrong is a size beyond `max_size`.
[[nodiscard]] Plan compile_or_throw(const Graph& graph, int width, int height, int max_size = 16384);

}  // namespace viscera
