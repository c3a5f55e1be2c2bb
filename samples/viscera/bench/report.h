#pragma once

#include <iosfwd>
#include <span>

#include "samples/viscera/bench/lab.h"

namespace viscera::app {

/// One aligned table per case: time, error, ratio and goal side by side.
void print_table(std::ostream& out, std::span<const Row> rows, bool hardware);
[[nodiscard]] nlohmann::json to_json(std::span<const Row> rows, bool hardware);

}  // namespace viscera::app
