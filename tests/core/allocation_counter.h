#pragma once

#include <cstddef>

namespace viscera::test {

/// Number of calls of operator new in this binary so far.
[[nodiscard]] std::size_t allocation_count();

}  // namespace viscera::test
