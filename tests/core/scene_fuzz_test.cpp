#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/core/sample_scene.h"

namespace viscera {
namespace {

using nlohmann::json;

/// Seeded mutations of the valid scene: read, or refused with an Error, and nothing else.
TEST(SceneFuzz, MutatedTextNeverCrashes) {
    std::mt19937 random(20240601);
    const auto below = [&random](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    const std::string alphabet(
        "{}[]\",:0123456789.-+eE\\/$# \n\0\xFF\xC3"
        "truefalsn",
        41);
    int refused = 0;
    constexpr int rounds = 4000;
    for (int round = 0; round < rounds; ++round) {
        std::string text = valid_scene;
        for (std::size_t n = 1 + below(4); n > 0 && !text.empty(); --n) {
            const std::size_t at = below(text.size());
            const std::size_t length = std::min(1 + below(20), text.size() - at);
            switch (below(4)) {
                case 0:
                    text[at] = alphabet[below(alphabet.size())];
                    break;
                case 1:
                    text.erase(at, length);
                    break;
                case 2:
                    text.insert(below(text.size()), text.substr(at, length));
                    break;
                default:
                    text.resize(std::max<std::size_t>(at, 1));
            }
        }
        try {
            (void)parse(text);
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.code(), ErrorCode::scene);
            EXPECT_NO_THROW((void)json(error.what()).dump()) << "the message is UTF-8";
        }
    }
    EXPECT_GT(refused, rounds / 2);
    EXPECT_LT(refused, rounds);
}

TEST(SceneFuzz, MutatedValuesNeverCrash) {
    std::mt19937 random(7);
    const auto below = [&random](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    const json flat = json::parse(valid_scene).flatten();
    std::vector<std::string> places;
    for (const auto& [pointer, value] : flat.items()) {
        for (std::string place = pointer; !place.empty(); place.resize(place.rfind('/'))) {
            places.push_back(place);
        }
    }
    const std::vector<json> values{nullptr,
                                   true,
                                   -1,
                                   0,
                                   1,
                                   1e300,
                                   -0.5,
                                   1LL << 62,
                                   "",
                                   "x",
                                   "contrast.main",
                                   "../..",
                                   json::array(),
                                   json::object(),
                                   {1, 2},
                                   {{"$ref", "#/shared/fast"}},
                                   {{"$ref", "#/shared/flow"}, {"rate", 1}},
                                   {{"$ref", "#/shared"}},
                                   {{"$ref", ""}}};
    int read = 0;
    int refused = 0;
    for (int round = 0; round < 4000; ++round) {
        json document = json::parse(valid_scene);
        for (std::size_t n = 1 + below(3); n > 0; --n) {
            const json::json_pointer place(places[below(places.size())]);
            if (document.contains(place)) {
                document[place] = values[below(values.size())];
            }
        }
        try {
            const Scene scene = parse(document.dump());
            ++read;
            EXPECT_GT(scene.width, 0);
            EXPECT_FALSE(scene.outputs.empty());
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.code(), ErrorCode::scene);
        }
    }
    EXPECT_GT(read, 50);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace viscera
