#include "engine/io/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using testing::HasSubstr;

class TransferFunctionFile : public testing::Test {
  protected:
    std::vector<TransferFunction> load(std::string_view name, std::string_view text) {
        return load_transfer_functions(folder_.write(name, text), log_);
    }
    TransferFunction one(std::string_view name, std::string_view text) {
        const std::vector<TransferFunction> all = load(name, text);
        EXPECT_EQ(all.size(), 1U);
        return all.at(0);
    }
    /// The message of the error, which must be one of the file and name it.
    std::string error_of(std::string_view name, std::string_view text) {
        try {
            (void)load(name, text);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_THAT(error.where(), HasSubstr(std::string(name)));
            return std::string(error.message());
        }
        ADD_FAILURE() << "was taken: " << text;
        return "";
    }

    test::TempFolder folder_;
    Log log_;
};

void expect_colour(const TransferFunction& f, double value, const glm::dvec3& colour, double tolerance) {
    const glm::dvec4 found = evaluate(f, value);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found[c], colour[c], tolerance) << "component " << c << " at " << value;
    }
}

constexpr std::string_view slicer_text =
    "1\n1\n0.8\n0.15\n0.25\n12.5\n"
    "6 -200 0 40 0.25 900 0.75\n"
    "4 0 0.5 300 1\n"
    "12 -200 0.1 0.2 0.3 340 0.9 0.4 0.1 900 1 1 0.5\n";

TEST_F(TransferFunctionFile, SlicerText) {
    const TransferFunction f = one("heart.vp", slicer_text);
    EXPECT_EQ(f.name, "heart");
    EXPECT_TRUE(f.shaded);
    EXPECT_FALSE(f.nearest);
    EXPECT_EQ(f.technique, Technique::composite);
    EXPECT_EQ(f.reference_length_mm, 1.0);
    EXPECT_EQ(f.lighting, (Lighting{.ambient = 0.15, .diffuse = 0.8, .specular = 0.25, .shininess = 12.5}));
    EXPECT_EQ(f.gradient, (std::vector<GradientPoint>{{0.0, 0.5}, {300.0, 1.0}}));
    // Each of the two curves keeps its own knots.
    ASSERT_EQ(f.points.size(), 4U);
    EXPECT_DOUBLE_EQ(evaluate(f, -80.0).w, 0.125);
    EXPECT_DOUBLE_EQ(evaluate(f, 40.0).w, 0.25);
    EXPECT_NEAR(evaluate(f, 470.0).w, 0.5, 1e-15);
    expect_colour(f, 70.0, {0.5, 0.3, 0.2}, 1e-15);
    expect_colour(f, 340.0, {0.9, 0.4, 0.1}, 1e-15);
    expect_colour(f, 2000.0, {1.0, 1.0, 0.5}, 0.0);
    EXPECT_TRUE(log_.faults().empty());
}

TEST_F(TransferFunctionFile, SlicerTextNearestUnlitWithoutGradient) {
    const TransferFunction f =
        one("a.VP", "0\r\n0\r\n1\r\n0\r\n0\r\n1\r\n4 0 0 1 1\r\n4 0 1 255 1\r\n4 0 1 1 1\r\n");
    EXPECT_TRUE(f.nearest);
    EXPECT_FALSE(f.shaded);
    EXPECT_TRUE(f.gradient.empty()) << "a factor of 1 everywhere is no second axis";
}

TEST_F(TransferFunctionFile, SlicerTextDuplicatesAreSteps) {
    const TransferFunction f = one("a.vp", "1\n0\n1\n0\n0\n1\n8 0 0 5 0.5 5 0.1 9 0.1\n0\n4 0 1 1 1\n");
    EXPECT_NEAR(evaluate(f, 4.999999).w, 0.5, 1e-6);
    EXPECT_EQ(evaluate(f, 5.0).w, 0.1);
}

TEST_F(TransferFunctionFile, SlicerTextFaultsNameLineAndKey) {
    const std::string head = "1\n1\n0.8\n0.1\n0.2\n10\n";
    EXPECT_THAT(error_of("a.vp", ""), HasSubstr("line 1, interpolation: is missing"));
    EXPECT_THAT(error_of("a.vp", "7\n"), HasSubstr("interpolation: must be 0 (nearest)"));
    EXPECT_THAT(error_of("a.vp", "1\nyes\n"), HasSubstr("line 2, shade: must be a finite number"));
    EXPECT_THAT(error_of("a.vp", "1\n2\n"), HasSubstr("shade: must be 0 or 1"));
    EXPECT_THAT(error_of("a.vp", "1\n1\nnan\n"), HasSubstr("diffuse: must be a finite number"));
    EXPECT_THAT(error_of("a.vp", head), HasSubstr("line 7, scalar opacity: is missing"));
    EXPECT_THAT(error_of("a.vp", head + "0\n"), HasSubstr("scalar opacity: has no points"));
    EXPECT_THAT(error_of("a.vp", head + "4 0 0 1\n"), HasSubstr("scalar opacity: ends too early"));
    EXPECT_THAT(error_of("a.vp", head + "3 0 0 1\n"), HasSubstr("must be a multiple of 2"));
    EXPECT_THAT(error_of("a.vp", head + "-2\n"), HasSubstr("must be a multiple of 2"));
    EXPECT_THAT(error_of("a.vp", head + "2 0 0 1\n"), HasSubstr("more numbers than its count"));
    EXPECT_THAT(error_of("a.vp", head + "2000000000 0 0\n"), HasSubstr("more than 16384 points"));
    EXPECT_THAT(error_of("a.vp", head + "2 0 1\n2 0 1\n6 0 1 1 1 1 1\n"),
                HasSubstr("line 9, colour: count must be a multiple of 4"));
}

constexpr std::string_view slicer_json = R"({"@schema": "volume-property-schema-v1.0.0.json#",
 "volumeProperties": [{"effectiveRange": [-90, 400], "isoSurfaceValues": [], "interpolationType": "nearest",
  "components": [{"shade": true, "disableGradientOpacity": false, "scalarOpacityUnitDistance": 2.5,
   "lighting": {"ambient": 0.3, "diffuse": 0.6, "specular": 0.1, "specularPower": 7},
   "scalarOpacity": {"points": [{"x": -90, "y": 0.2, "midpoint": 0.3, "sharpness": 0.5},
                                {"x": 10, "y": 0.9, "midpoint": 0.5, "sharpness": 0},
                                {"x": 400, "y": 0.1}]},
   "gradientOpacity": {"points": [{"x": 0, "y": 0.25}, {"x": 80, "y": 0.75}]},
   "rgbTransferFunction": {"points": [{"x": 400, "color": [1, 1, 0], "midpoint": 0.5, "sharpness": 0},
                                      {"x": -90, "color": [0, 0.5, 1], "midpoint": 0.5, "sharpness": 1}]}}]}]})";

TEST_F(TransferFunctionFile, SlicerJson) {
    for (const char* name : {"liver.vp.json", "liver.json"}) {
        const TransferFunction f = one(name, slicer_json);
        EXPECT_EQ(f.name, "liver");
        EXPECT_TRUE(f.shaded);
        EXPECT_TRUE(f.nearest);
        EXPECT_EQ(f.reference_length_mm, 2.5);
        EXPECT_EQ(f.lighting, (Lighting{.ambient = 0.3, .diffuse = 0.6, .specular = 0.1, .shininess = 7.0}));
        EXPECT_EQ(f.gradient, (std::vector<GradientPoint>{{0.0, 0.25}, {80.0, 0.75}}));
        EXPECT_NEAR(evaluate(f, 205.0).w, 0.5, 1e-12);
        // Sharpness 1 is a step half way.
        expect_colour(f, 154.999, {0.0, 0.5, 1.0}, 0.0);
        expect_colour(f, 155.0, {1.0, 1.0, 0.0}, 0.0);
    }
}

/// An opacity curve over [0, 10] from 0.2 to 0.9 of one shape.
std::string opacity_map(double midpoint, double sharpness) {
    return R"([{"Name":"m","RGBPoints":[0,0,0,0,10,1,1,1],"Points":[0,0.2,)" + std::to_string(midpoint) +
           "," + std::to_string(sharpness) + ",10,0.9,0.5,0]}]";
}

// Values of vtkPiecewiseFunction of VTK 9.1 at 1, 2.5, 3.5, 5, 6, 7.5, 9.
TEST_F(TransferFunctionFile, MidpointAndSharpnessAreAsInVtk) {
    struct Case {
        double midpoint, sharpness, values[7];
    };
    const Case cases[]{{0.5, 0.0, {0.27, 0.375, 0.445, 0.55, 0.62, 0.725, 0.83}},
                       {0.3, 0.0, {0.316667, 0.491667, 0.575, 0.65, 0.7, 0.775, 0.85}},
                       {0.5, 1.0, {0.2, 0.2, 0.2, 0.9, 0.9, 0.9, 0.9}},
                       {0.3, 0.5, {0.200241, 0.284762, 0.702994, 0.872333, 0.893593, 0.899636, 0.899999}},
                       {0.7, 0.25, {0.200289, 0.207243, 0.224197, 0.292023, 0.388987, 0.731147, 0.894327}},
                       {0.4, 0.05, {0.241956, 0.369643, 0.484935, 0.63572, 0.712643, 0.808843, 0.877257}}};
    const double places[]{1.0, 2.5, 3.5, 5.0, 6.0, 7.5, 9.0};
    for (const Case& c : cases) {
        const TransferFunction f = one("a.json", opacity_map(c.midpoint, c.sharpness));
        const bool exact = c.sharpness == 0.0 || c.sharpness == 1.0;
        for (std::size_t i = 0; i < 7; ++i) {
            EXPECT_NEAR(evaluate(f, places[i]).w, c.values[i], exact ? 1e-6 : 5e-4)
                << "midpoint " << c.midpoint << " sharpness " << c.sharpness << " at " << places[i];
        }
        EXPECT_EQ(evaluate(f, 10.0).w, 0.9);
        EXPECT_LT(f.points.size(), 200U);
    }
    EXPECT_EQ(one("a.json", opacity_map(0.5, 0.0)).points.size(), 2U) << "what is straight stays so";
    EXPECT_EQ(one("a.json", opacity_map(0.3, 0.0)).points.size(), 3U);
}

/// The definition of VTK's node shape, for a scan of the whole interval.
double vtk_shape(double t, double midpoint, double sharpness) {
    double s = t < midpoint ? 0.5 * t / midpoint : 0.5 + 0.5 * (t - midpoint) / (1.0 - midpoint);
    s = s < 0.5 ? 0.5 * std::pow(2.0 * s, 1.0 + 10.0 * sharpness)
                : 1.0 - 0.5 * std::pow(2.0 - 2.0 * s, 1.0 + 10.0 * sharpness);
    const double slope = (1.0 - sharpness) * 0.7;
    const double y = (2 * s * s * s - 3 * s * s + 1) * 0.2 + (3 * s * s - 2 * s * s * s) * 0.9 +
                     (s * s * s - 2 * s * s + s) * slope + (s * s * s - s * s) * slope;
    return std::clamp(y, 0.2, 0.9);
}

TEST_F(TransferFunctionFile, SharpCurvesAreWithinAThousandthEverywhere) {
    for (const double midpoint : {0.1, 0.5, 0.83}) {
        for (const double sharpness : {0.02, 0.3, 0.75, 0.98}) {
            const TransferFunction f = one("a.json", opacity_map(midpoint, sharpness));
            double worst = 0.0;
            for (int i = 0; i <= 20000; ++i) {
                const double t = i / 20000.0;
                worst =
                    std::max(worst, std::abs(evaluate(f, 10.0 * t).w - vtk_shape(t, midpoint, sharpness)));
            }
            EXPECT_LT(worst, 1e-3) << midpoint << " " << sharpness;
        }
    }
}

std::string colour_map(std::string_view space, std::string_view from, std::string_view to,
                       std::string_view more = "") {
    return R"([{"Name":"m","ColorSpace":")" + std::string(space) + R"(","NanColor":[1,0,0],"RGBPoints":[0,)" +
           std::string(from) + ",1," + std::string(to) + "]" + std::string(more) + "}]";
}

// Values of vtkColorTransferFunction of VTK 9.1 at 0.1, 0.45, 0.6, 0.9.
TEST_F(TransferFunctionFile, ColourSpacesAreAsInVtk) {
    struct Case {
        std::string_view space, from, to, more;
        glm::dvec3 colours[4];
    };
    const Case cases[]{
        {"Lab",
         "0.23,0.3,0.75",
         "0.7,0.02,0.15",
         "",
         {{0.35343, 0.282406, 0.686591},
          {0.558114, 0.21513, 0.471728},
          {0.608812, 0.181183, 0.382962},
          {0.681377, 0.085059, 0.209187}}},
        {"CIELAB",
         "0,0,1",
         "1,0,0",
         "",
         {{0.407852, 0.0, 0.904008},
          {0.760507, 0.0, 0.580086},
          {0.843075, 0.0, 0.446024},
          {0.966096, 0.0, 0.165064}}},
        {"Diverging",
         "0.23,0.3,0.75",
         "0.7,0.02,0.15",
         "",
         {{0.344778, 0.46944, 0.886922},
          {0.810496, 0.854442, 0.918936},
          {0.944575, 0.794482, 0.714309},
          {0.835573, 0.325512, 0.264467}}},
        {"Diverging",
         "0.2,0.7,0.3",
         "0.9,0.8,0.1",
         "",
         {{0.294016, 0.713978, 0.273479},
          {0.542812, 0.756947, 0.179435},
          {0.640461, 0.771979, 0.141244},
          {0.834841, 0.794759, 0.094828}}},
        {"Diverging",
         "0,0,1",
         "1,0,0",
         "",
         {{0.51679, 0.344622, 1.0},
          {0.944553, 0.906295, 1.0},
          {1.0, 0.88106, 0.750268},
          {1.0, 0.431894, 0.186891}}},
        {"HSV",
         "0.23,0.3,0.75",
         "0.7,0.02,0.15",
         "",
         {{0.239838, 0.207749, 0.745},
          {0.572645, 0.132059, 0.7275},
          {0.72, 0.100663, 0.700523},
          {0.705, 0.039749, 0.296217}}},
        {"HSV", "0,0,1", "1,0,0", "", {{0.0, 0.4, 1.0}, {0.0, 1.0, 0.2}, {0.4, 1.0, 0.0}, {1.0, 0.4, 0.0}}},
        {"HSV",
         "0,0,1",
         "1,0,0",
         R"(,"HSVWrap":1)",
         {{0.2, 0.0, 1.0}, {0.9, 0.0, 1.0}, {1.0, 0.0, 0.8}, {1.0, 0.0, 0.2}}},
        {"RGB", "0,0,1", "1,0,0", "", {{0.1, 0.0, 0.9}, {0.45, 0.0, 0.55}, {0.6, 0.0, 0.4}, {0.9, 0.0, 0.1}}},
        {"Step",
         "0.1,0.2,0.3",
         "0.9,0.5,0.4",
         "",
         {{0.9, 0.5, 0.4}, {0.9, 0.5, 0.4}, {0.9, 0.5, 0.4}, {0.9, 0.5, 0.4}}}};
    const double places[]{0.1, 0.45, 0.6, 0.9};
    for (const Case& c : cases) {
        SCOPED_TRACE(std::string(c.space) + " " + std::string(c.from));
        const TransferFunction f = one("a.json", colour_map(c.space, c.from, c.to, c.more));
        for (std::size_t i = 0; i < 4; ++i) {
            expect_colour(f, places[i], c.colours[i], 5e-4);
        }
    }
}

TEST_F(TransferFunctionFile, ParaViewMaps) {
    const std::vector<TransferFunction> all = load("maps.json", R"([
        {"Name": "warm", "RGBPoints": [-5, 0.1, 0.2, 0.3, 5, 1, 0.8, 0.6]},
        {"Name": "tissues", "IndexedColors": [1, 0, 0, 0, 1, 0], "Annotations": ["1", "a"]},
        {"RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "Points": [0, 1, 0.5, 0, 1, 0.5, 0.5, 0]}])");
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].name, "warm");
    EXPECT_EQ(all[1].name, "maps");
    // Without opacity of its own: a ramp.
    EXPECT_EQ(evaluate(all[0], -5.0).w, 0.0);
    EXPECT_EQ(evaluate(all[0], 0.0).w, 0.5);
    EXPECT_EQ(evaluate(all[0], 5.0).w, 1.0);
    EXPECT_EQ(evaluate(all[1], 0.5).w, 0.75);
    EXPECT_EQ(log_.faults().at("transfer function: maps of categories left out"), 1U);
    EXPECT_EQ(one("b.json", R"({"RGBPoints": [0, 0, 0, 0]})").name, "b");
}

TEST_F(TransferFunctionFile, ParaViewFaultsNameTheKey) {
    EXPECT_THAT(error_of("a.json", "[]"), HasSubstr("holds no colour map"));
    EXPECT_THAT(error_of("a.json", R"([{"IndexedColors":[1,0,0]}])"),
                HasSubstr("/0/IndexedColors: colours for"));
    EXPECT_THAT(error_of("a.json", R"([{"Name":"x"}])"), HasSubstr("/0: has no \"RGBPoints\""));
    EXPECT_THAT(error_of("a.json", R"([{"RGBPoints":[0,1,1]}])"), HasSubstr("/0/RGBPoints: must hold value"));
    EXPECT_THAT(error_of("a.json", R"([{"RGBPoints":[0,1,1,"x"]}])"),
                HasSubstr("/0/RGBPoints/3: must be a number, is a string"));
    EXPECT_THAT(error_of("a.json", R"([7])"), HasSubstr("/0: must be an object"));
    EXPECT_THAT(error_of("a.json", colour_map("CIEDE2000", "0,0,0", "1,1,1")),
                HasSubstr("/0/ColorSpace: must be"));
    EXPECT_THAT(error_of("a.json", opacity_map(1.5, 0.0)), HasSubstr("/0/Points/2: must be from 0 to 1"));
    EXPECT_THAT(error_of("a.json", opacity_map(0.5, -1.0)), HasSubstr("/0/Points/3: must be from 0 to 1"));
}

TEST_F(TransferFunctionFile, SlicerJsonFaultsNameTheKey) {
    const auto replaced = [](std::string_view what, std::string_view by) {
        std::string text(slicer_json);
        const std::size_t at = text.find(what);
        EXPECT_NE(at, std::string::npos) << what;
        return text.replace(at, what.size(), by);
    };
    EXPECT_THAT(error_of("a.vp.json", replaced("\"nearest\"", "\"best\"")),
                HasSubstr("/volumeProperties/0/interpolationType: must be nearest, linear or cubic"));
    EXPECT_THAT(error_of("a.vp.json", replaced("\"y\": 0.9", "\"z\": 0.9")),
                HasSubstr("/volumeProperties/0/components/0/scalarOpacity/points/1: has no \"y\""));
    EXPECT_THAT(error_of("a.vp.json", replaced("[1, 1, 0]", "[1, 1]")), HasSubstr("color: must be red"));
    EXPECT_THAT(error_of("a.vp.json", replaced("2.5", "0")),
                HasSubstr("scalarOpacityUnitDistance: must be above 0"));
    EXPECT_THAT(error_of("a.vp.json", replaced("scalarOpacity\"", "opacity\"")),
                HasSubstr("has no \"scalarOpacity\""));
    EXPECT_THAT(error_of("a.vp.json", R"({"volumeProperties":[]})"),
                HasSubstr("/volumeProperties: is empty"));
    EXPECT_THAT(error_of("a.vp.json", R"({"volumeProperties":[{"components":[]}]})"),
                HasSubstr("has no components"));
    EXPECT_THAT(error_of("a.vp.json", R"({"volumeProperties":{}})"),
                HasSubstr("must be a list, is an object"));
}

TEST_F(TransferFunctionFile, OwnForm) {
    const TransferFunction f = one("a.json", R"({"name": "two", "doc": "x", "technique": "isosurface",
        "shaded": true, "lighting": {"specular": 0.5}, "nearest": true, "reference_length_mm": 2,
        "points": [{"value": 7, "opacity": 1, "colour": [1, 0, 0]}, {"value": 3}],
        "gradient": [{"gradient": 4, "factor": 0.5}]})");
    EXPECT_EQ(f.name, "two");
    EXPECT_EQ(f.technique, Technique::isosurface);
    EXPECT_TRUE(f.shaded);
    EXPECT_TRUE(f.nearest);
    EXPECT_EQ(f.lighting.specular, 0.5);
    EXPECT_EQ(f.lighting.diffuse, Lighting{}.diffuse);
    EXPECT_EQ(f.reference_length_mm, 2.0);
    ASSERT_EQ(f.points.size(), 2U);
    EXPECT_EQ(f.points[0].value, 3.0);
    EXPECT_EQ(f.gradient.size(), 1U);
    EXPECT_THAT(error_of("a.json", R"({"points": [{"value": 1, "opacty": 1}]})"),
                HasSubstr("/points/0/opacty"));
    EXPECT_THAT(error_of("a.json", R"({"points": [{"value": 1, "opacity": 3}]})"),
                HasSubstr("/points/0/opacity"));
    EXPECT_THAT(error_of("a.json", R"({"points": [], "reference_length_mm": 0})"),
                HasSubstr("/reference_length_mm"));
    EXPECT_EQ(one("empty.json", R"({"points": []})").points, (std::vector<TransferPoint>{{}}));
}

TEST_F(TransferFunctionFile, WhatIsOutOfRangeIsCutAndCounted) {
    const TransferFunction f = one("a.vp", "1\n1\n0.8\n-0.1\n0.2\n10\n4 0 0 1 1\n2 -5 0.5\n4 0 1 1 1\n");
    EXPECT_EQ(f.lighting.ambient, 0.0);
    EXPECT_EQ(f.gradient, (std::vector<GradientPoint>{{0.0, 0.5}}));
    EXPECT_EQ(log_.faults().at("transfer function: numbers out of range"), 2U);
}

TEST_F(TransferFunctionFile, OtherFilesAreRefused) {
    EXPECT_THAT(error_of("a.txt", "1"), HasSubstr(".vp, .vp.json and .json"));
    EXPECT_THAT(error_of("a.json", "{"), HasSubstr("line 1"));
    EXPECT_THAT(error_of("a.json", "7"), HasSubstr("is no transfer function"));
    EXPECT_THAT(error_of("a.json", R"({"colour": 1})"), HasSubstr("is no transfer function"));
    EXPECT_THROW((void)load_transfer_functions(folder_ / "none.vp", log_), Error);
}

TEST(TransferFunctionPresets, AllAreSound) {
    const std::filesystem::path folder =
        std::filesystem::path(VISCERA_SOURCE_DIR) / "assets/transfer_functions";
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        Log log;
        const std::vector<TransferFunction> all = load_transfer_functions(entry.path(), log);
        ASSERT_EQ(all.size(), 1U);
        const TransferFunction& f = all[0];
        EXPECT_TRUE(log.faults().empty()) << entry.path();
        EXPECT_EQ(f.name, entry.path().stem()) << entry.path();
        EXPECT_EQ(f.points.front().opacity, 0.0) << "what lies below must be left out: " << entry.path();
        EXPECT_FALSE(visible_ranges(f).empty());
        EXPECT_TRUE(std::ranges::is_sorted(f.points, {}, &TransferPoint::value));
        names.push_back(f.name);
    }
    std::ranges::sort(names);
    EXPECT_EQ(names, (std::vector<std::string>{"ct-angiography", "ct-bone", "ct-lung", "ct-skin-and-bone",
                                               "ct-soft-tissue", "mr-angiography", "mr-brain", "tooth",
                                               "ultrasound"}));
}

}  // namespace
}  // namespace viscera::io
