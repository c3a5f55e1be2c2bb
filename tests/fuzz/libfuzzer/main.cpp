#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/targets.h"

/// One program per target, named by the build. What run() throws ends the program: a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto targets = viscera::fuzz::targets();
    const auto found = std::ranges::find(targets, VISCERA_FUZZ_TARGET, &viscera::fuzz::Target::name);
    if (found == targets.end()) {
        std::abort();
    }
    found->run({reinterpret_cast<const char*>(data), size});
    return 0;
}
