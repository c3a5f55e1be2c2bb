#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace viscera::fuzz {

/// A reader of untrusted bytes. run() returns for whatever it is given; it throws where the reader lets
/// something else escape than the Error it documents, or gives a result that does not hold together.
struct Target {
    std::string_view name;
    void (*run)(std::string_view bytes);
    std::vector<std::string> (*seeds)();  ///< sound inputs to start from
};

[[nodiscard]] std::span<const Target> targets();

}  // namespace viscera::fuzz
