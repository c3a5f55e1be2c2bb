#pragma once

#include <random>
#include <span>
#include <string>

namespace viscera::fuzz {

/// A damaged copy of one of the seeds: bits flipped, pieces cut, doubled, moved and replaced by numbers and
/// words at which readers stumble. The same generator gives the same damage on every machine.
[[nodiscard]] std::string mutate(std::span<const std::string> seeds, std::mt19937& random);

}  // namespace viscera::fuzz
