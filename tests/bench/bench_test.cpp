#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/io/temp_folder.h"

namespace viscera::test {
namespace {

using nlohmann::json;

/// Runs the app's bench, small and short. Ratios are judged by processor time, which other programs on the
/// machine hardly change.
json bench(const std::string& arguments) {
    const TempFolder folder;
    const auto report = folder / "report.json";
    const std::string command = std::string("\"") + VISCERA_APP + "\" bench " + arguments +
                                " --backend osmesa --report \"" + report.string() + "\" >\"" +
                                (folder / "out.txt").string() + "\" 2>\"" + (folder / "err.txt").string() +
                                "\"";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    std::ifstream stream(report);
    json document = json::parse(stream, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << command;
    return document;
}

json row(const json& document, const std::string& group, const std::string& name) {
    for (const json& one : document["rows"]) {
        if (one["case"] == group && one["name"] == name) {
            return one;
        }
    }
    ADD_FAILURE() << "no row '" << name << "' in " << group;
    return {};
}

TEST(Bench, EveryRowHasATimeOrAFigureAndEveryRatioACeiling) {
    const json document = bench("ceilings readback summarize opacity --resolution 64x64 --repeats 3");
    EXPECT_EQ(document["resolution"], json({64, 64}));
    EXPECT_EQ(document["software"], true);
    EXPECT_EQ(document["clock"], "wall clock, glFinish");
    std::set<std::string> groups;
    for (const json& one : document["rows"]) {
        groups.insert(one["case"].get<std::string>());
        EXPECT_TRUE(one.contains("time_ms") || one.contains("value")) << one;
        EXPECT_EQ(one.contains("ratio"), one.contains("ceiling")) << one;
        EXPECT_EQ(one.contains("error"), one.contains("error_against")) << one;
        if (one.contains("time_ms")) {
            const json& time = one["time_ms"];
            EXPECT_GT(time["median"].get<double>(), 0.0) << one;
            EXPECT_LE(time["lower"].get<double>(), time["median"].get<double>()) << one;
            EXPECT_LE(time["median"].get<double>(), time["upper"].get<double>()) << one;
        }
    }
    EXPECT_EQ(groups, (std::set<std::string>{"ceilings", "readback", "summarize", "opacity"}));
    for (const char* format :
         {"r8", "rg8", "rgba8", "r16f", "rg16f", "rgba16f", "r32f", "rg32f", "rgba32f"}) {
        row(document, "ceilings", std::string("copy ") + format);
        row(document, "readback", std::string(format) + " waiting");
    }
}

TEST(Bench, ErrorsStandBesideTimes) {
    const json document = bench("summarize composite opacity --resolution 64x64 --repeats 3");
    // Half targets truncate: at most one unit of half float below 1.
    constexpr double half_unit = 1.0 / 1024.0;
    EXPECT_LE(row(document, "summarize", "smooth")["error"], half_unit);
    EXPECT_LE(row(document, "composite", "5 layers, beer_lambert")["error"], half_unit);
    EXPECT_LE(row(document, "composite", "5 layers, thesis")["error"], half_unit);
    EXPECT_LE(row(document, "opacity", "closed form, alone")["error"], 4e-7);
    EXPECT_LE(row(document, "opacity", "25 terms, alone")["error"], 2e-6);
}

TEST(Bench, ACachedFrameCostsAtMostATwentieth) {
    const json document = bench("cached --resolution 256x256 --repeats 9");
    const json cached = row(document, "cached", "cached frame");
    EXPECT_LE(cached["cpu_ratio"].get<double>(), 0.05);
    EXPECT_EQ(cached["error"], 0.0);
    EXPECT_EQ(cached["met"], true);
}

TEST(Bench, OnePassOverTheVesselsIsNoDearerThanThree) {
    const json document = bench("geometry --resolution 256x256 --repeats 15");
    const json fused = row(document, "geometry", "one pass");
    EXPECT_LE(fused["cpu_ratio"].get<double>(), 1.0);
    EXPECT_EQ(fused["error"], 0.0);
}

TEST(Bench, ASpritesCostGrowsWithItsArea) {
    const json document = bench("sprites --resolution 512x512 --repeats 9");
    EXPECT_GT(row(document, "sprites", "slope")["value"].get<double>(), 0.0);
    const double small = row(document, "sprites", "size 0.2")["cpu_ms"]["median"];
    const double large = row(document, "sprites", "size 2.4")["cpu_ms"]["median"];
    EXPECT_LT(small, 0.6 * large) << "hardly any area is to cost hardly anything";
}

TEST(Bench, AnUnknownCaseIsAUsageError) {
    const std::string command = std::string("\"") + VISCERA_APP + "\" bench no_such_case >/dev/null 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 2);
}

}  // namespace
}  // namespace viscera::test
