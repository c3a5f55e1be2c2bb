#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/plan.h"

namespace viscera {

/// Where a pass of an expanded graph comes from.
struct EyePass {
    std::size_t source = 0;  ///< index of the pass in the graph that was expanded
    int eye = -1;            ///< 0 left, 1 right; -1: one pass serves both
};

/// A graph for a frame of two eyes.
struct EyeGraph {
    Graph graph;
    std::vector<EyePass> passes;              ///< of each pass of `graph`
    std::set<std::string, std::less<>> eyed;  ///< names that hold a picture per eye at the end of the frame
    std::vector<Fault> faults;

    /// What an output that is asked for as `name` is called: itself, or `NAME.left` and `NAME.right`.
    [[nodiscard]] std::vector<std::string> names_of(std::string_view name) const;
};

/// Makes each pass that depends on the eye twice, the others once. A pass depends on the eye when
/// `uses_view` says so (one entry per pass), or when it reads or modifies what such a pass has made. Of what
/// those write, each eye has its own: `NAME` becomes `NAME.left` and `NAME.right`, and so do passes and
/// outputs; the two follow each other in the place of the one. A name that is shared up to some pass and per
/// eye from there on stays shared above it. What is modified per eye is made per eye. A pass that reads
/// `NAME.left` or `NAME.right` in so many words sees that eye's content and may serve both.
///
/// The host imports per eye what differs: `depth.left` and `depth.right` are what a read of `depth` means.
/// Faults: an imported target that both eyes would draw into, and a name that is taken already. Pure.
[[nodiscard]] EyeGraph expand_eyes(const Graph& graph, std::span<const char> uses_view);

}  // namespace viscera
