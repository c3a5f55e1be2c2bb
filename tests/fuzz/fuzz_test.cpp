#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"

namespace viscera::fuzz {
namespace {

class Fuzz : public testing::TestWithParam<Target> {};

TEST_P(Fuzz, SeedsAreTaken) {
    for (const std::string& seed : GetParam().seeds()) {
        EXPECT_NO_THROW(GetParam().run(seed));
    }
}

/// VISCERA_FUZZ_ROUNDS: how many inputs (default 500).
TEST_P(Fuzz, DamagedInputIsSurvived) {
    const char* wanted = std::getenv("VISCERA_FUZZ_ROUNDS");
    const int rounds = wanted == nullptr ? 500 : std::atoi(wanted);
    const std::vector<std::string> seeds = GetParam().seeds();
    std::mt19937 random(20250119U);
    for (int round = 0; round < rounds; ++round) {
        const std::string bytes = mutate(seeds, random);
        try {
            GetParam().run(bytes);
        } catch (const std::exception& error) {
            FAIL() << "round " << round << ": " << error.what() << "\n" << testing::PrintToString(bytes);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Readers, Fuzz, testing::ValuesIn(targets().begin(), targets().end()),
                         [](const testing::TestParamInfo<Target>& info) {
                             return std::string(info.param.name);
                         });

}  // namespace
}  // namespace viscera::fuzz
