#pragma once

#include <string>

#include "engine/core/plan.h"

namespace viscera {

/// The plan as a text table: one row per pass (name, effect, live or not and why, reads, writes), then one
/// row per target content (name, format, size, lifetime, texture), then the memory in use with and without
/// sharing.
[[nodiscard]] std::string to_table(const Plan& plan);

/// The plan as a Graphviz digraph: boxes are passes (grey when not live, with the reason), ellipses are
/// contents.
[[nodiscard]] std::string to_dot(const Plan& plan);

}  // namespace viscera
