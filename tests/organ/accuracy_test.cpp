#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/organ/organ_stage.h"

// Every input of the organ's shader, alone and all at once, against the double-precision reference.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double bound = 1e-5;
constexpr std::size_t least_content = 2500;

float wave(double u, double v, int c) {
    return static_cast<float>(0.5 + 0.5 * std::sin(9.0 * u + 1.3 * c) * std::cos(7.0 * v - 0.8 * c));
}

class OrganAccuracy : public testing::Test {
  protected:
    void SetUp() override { before_ = s.render(); }
    /// Renders and compares all channels.
    void expect(const std::string& name, double time_s = 0.0, const HostValues* values = nullptr) {
        const Image image = s.render(time_s, values);
        EXPECT_NE(image.data, before_.data) << name << " changes nothing";
        before_ = image;
        for (const auto& [target, map] : reads_) {
            *map = s.read_target(target);
        }
        const reference::Buffer wanted = s.expected();
        double worst = 0.0;
        for (int c = 0; c < 4; ++c) {
            const Deviation found = deviation(image, wanted, c, c);
            EXPECT_EQ(found.not_finite, 0U) << name;
            EXPECT_LE(found.max, bound) << name << ", channel " << c << " at (" << found.x << ", " << found.y
                                        << "): " << found.got << " for " << found.wanted;
            EXPECT_GE(found.content, least_content) << name;
            worst = std::max(worst, found.max);
        }
        std::printf("  %-44s %.2fe-6\n", name.c_str(), worst * 1e6);
        EXPECT_TRUE(s.stage().complaints().empty()) << s.stage().complaints().front();
    }
    /// A target that is filled with waves and that the reference reads as `map`.
    void feed(const std::string& target, reference::OrganMap& map,
              const std::function<float(double, double, int)>& f = wave) {
        s.target(target, 32, f);
        reads_.emplace_back(target, &map);
    }
    /// Files repeat; the reference reads the same picture. Its texels are larger than pixels, so that it is
    /// not one of its smaller copies that is seen.
    std::string file(const std::string& name, reference::OrganMap& map,
                     const std::function<float(double, double, int)>& f = wave) {
        map = {.picture = to_buffer(OrganStage::picture(32, f)), .repeats = true};
        return s.picture_file(name, 32, f);
    }
    void use_normal_map(double strength = 0.8, double repeat = 1.25) {
        const auto normal = [](double u, double v, int c) {
            const double slope_u = 0.4 * std::cos(2.0 * std::numbers::pi * (u + v));
            const double slope_v = 0.3 * std::sin(2.0 * std::numbers::pi * v);
            const glm::dvec3 n = glm::normalize(glm::dvec3(-slope_u, -slope_v, 1.0));
            return c == 3 ? 1.0F : static_cast<float>(n[c]);
        };
        s.parameters["normal_map"] = {{"map", s.picture_file("normals.exr", 32, normal)},
                                      {"encoding", "signed"},
                                      {"strength", strength},
                                      {"repeat", repeat}};
        reference::Buffer slopes(32, 32, 2);
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 32; ++x) {
                const glm::dvec2 uv = slopes.uv(x, y);
                const double z = static_cast<double>(normal(uv.x, uv.y, 2));
                slopes.at(x, y, 0) = -static_cast<double>(normal(uv.x, uv.y, 0)) / z;
                slopes.at(x, y, 1) = -static_cast<double>(normal(uv.x, uv.y, 1)) / z;
            }
        }
        s.organ.slopes = {.picture = slopes, .repeats = true, .repeat = repeat};
        s.organ.bump = strength;
    }
    void use_membrane() {
        s.parameters["blending"] = "blended";
        s.parameters["opacity"] = 0.45;
        s.organ.blended = true;
        s.organ.opacity = 0.45;
    }
    void use_bruise() {
        s.parameters["hematoma"] = {{"spots", {{{"centre", {5, -8, 3}}, {"radius", 14}}}},
                                    {"colour", {0.2, 0.05, 0.1}},
                                    {"strength", 0.75}};
        s.organ.hematoma_colour = {0.2, 0.05, 0.1};
        s.organ.hematoma_strength = 0.75;
        s.organ.spots = {{5, -8, 3, 14}};
    }
    void use_energy() {
        feed("tissue.energy", s.organ.energy,
             [](double u, double v, int) { return static_cast<float>(1.6 * u * u - 0.9 * v); });
        s.organ.coagulation_colour = {0.8, 0.7, 0.5};
        s.organ.saturation = 0.7;
        s.organ.brightness = 1.1;
        s.parameters["coagulation"] = {{"colour", {0.8, 0.7, 0.5}}, {"saturation", 0.7}, {"brightness", 1.1}};
    }

    OrganStage s{96, 80};

  private:
    std::vector<std::pair<std::string, reference::OrganMap*>> reads_;
    Image before_;  ///< the plain organ, then what was expected last
};

TEST_F(OrganAccuracy, Plain) {
    s.parameters["colour"] = {0.5, 0.2, 0.3};
    s.organ.colour = {0.5, 0.2, 0.3};
    expect("plain");
}

TEST_F(OrganAccuracy, Orthographic) {
    s.camera["kind"] = "orthographic";
    s.camera["height_mm"] = 58;
    expect("orthographic");
}

TEST_F(OrganAccuracy, DiffuseMapOfAFile) {
    s.parameters["diffuse_map"] = file("diffuse.exr", s.organ.diffuse);
    s.parameters["diffuse_repeat"] = 1.25;
    s.organ.diffuse.repeat = 1.25;
    s.organ.colour = glm::dvec3(1.0);
    expect("diffuse map, file");
}

TEST_F(OrganAccuracy, OrthographicForOneEyeOfTwo) {
    s.camera["kind"] = "orthographic";
    s.camera["height_mm"] = 58;
    s.organ.slant = 0.11;
    expect("orthographic, slanted rays");
}

TEST_F(OrganAccuracy, PicturesSeenSmall) {
    // Levels are mixed by weights that OpenGL leaves to drivers: llvmpipe's are off by up to 1/4, so as to
    // read one level alone where it can. What is drawn lies between the references with such weights.
    s.parameters["shading"] = {{"ambient", 1}, {"diffuse", 0}, {"specular", 0}};
    s.organ.ambient = 1.0;
    s.organ.diffuse_share = s.organ.specular = 0.0;
    s.parameters["diffuse_map"] = file("small.exr", s.organ.diffuse, [](double u, double v, int c) {
        return static_cast<float>(0.5 + 0.4 * std::sin(60.0 * u + c) * std::cos(37.0 * v));
    });
    s.parameters["diffuse_repeat"] = 7.0;
    s.organ.diffuse.repeat = 7.0;
    s.organ.diffuse.make_smaller();
    s.organ.colour = glm::dvec3(1.0);
    const Image image = s.render();
    std::array<reference::Buffer, 2> ends;
    s.organ.nearer = -0.26;
    ends[0] = s.expected();
    s.organ.nearer = 0.26;
    ends[1] = s.expected();
    std::size_t mixed = 0;
    for (int y = 0; y < s.height; ++y) {
        for (int x = 0; x < s.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const auto [low, high] = std::minmax(ends[0].at(x, y, c), ends[1].at(x, y, c));
                const auto got = static_cast<double>(image.at(x, y, c));
                EXPECT_GE(got, low - bound) << x << ", " << y;
                EXPECT_LE(got, high + bound) << x << ", " << y;
                mixed += high - low > 100.0 * bound ? 1 : 0;
            }
        }
    }
    EXPECT_GT(mixed, least_content) << "elsewhere levels make no difference";
    s.organ.diffuse.smaller.clear();
    s.organ.nearer = 0.0;
    EXPECT_GT(deviation(image, s.expected(), 0, 0).max, 0.1) << "the picture itself, without levels";
}

TEST_F(OrganAccuracy, DiffuseMapOfATarget) {
    feed("organ.diffuse", s.organ.diffuse);
    s.organ.colour = {0.9, 0.8, 0.7};
    s.parameters["colour"] = {0.9, 0.8, 0.7};
    expect("diffuse map, target");
}

TEST_F(OrganAccuracy, NormalMap) {
    use_normal_map();
    expect("normal map");
}

TEST_F(OrganAccuracy, BackFaces) {
    use_normal_map();
    s.camera["eye_mm"] = {10, 90, -20};
    s.camera["up"] = {0, 0, 1};
    expect("normal map from behind");
    for (const char* faces : {"back", "front"}) {
        s.parameters["faces"] = faces;
        s.organ.front = std::string_view(faces) == "front";
        s.organ.back = !s.organ.front;
        const Image image = s.render();
        const reference::Buffer wanted = s.expected();
        EXPECT_LE(deviation(image, wanted, 0, 0).max, bound) << faces;
        const std::size_t content = deviation(image, wanted, 0, 0).content;
        EXPECT_EQ(content > 0, s.organ.back) << faces;
    }
}

TEST_F(OrganAccuracy, PlacedTurnedStretchedAndMirrored) {
    // Steep parts are seen small, but not so small that texels of a map that repeats so little are.
    use_normal_map(0.8, 0.4);
    use_bruise();
    for (const double mirror : {1.0, -1.0}) {
        s.parameters["mesh"]["placement"] = {
            {"move_mm", {2, -4, 3}}, {"rotate_deg", {14, -20, 35}}, {"scale", {mirror * 0.9, 1.6, 1.1}}};
        expect(mirror > 0.0 ? "placed" : "placed and mirrored");
    }
    s.parameters["faces"] = "front";
    s.organ.back = false;
    const Image image = s.render();
    EXPECT_LE(deviation(image, s.expected(), 0, 0).max, bound);
    EXPECT_GE(deviation(image, s.expected(), 0, 0).content, least_content) << "the front is the front still";
}

TEST_F(OrganAccuracy, GreenDown) {
    use_normal_map();
    s.parameters["normal_map"]["green_down"] = true;
    for (int y = 0; y < s.organ.slopes.picture.height; ++y) {
        for (int x = 0; x < s.organ.slopes.picture.width; ++x) {
            s.organ.slopes.picture.at(x, y, 1) *= -1.0;
        }
    }
    expect("normal map, green down");
}

TEST_F(OrganAccuracy, Energy) {
    use_energy();
    expect("energy");
    s.parameters["coagulation"]["burn_curve"] = "thesis";
    s.organ.thesis_burn = true;
    expect("energy, thesis curve");
}

TEST_F(OrganAccuracy, Blood) {
    feed("tissue.blood_color", s.organ.blood);
    expect("blood");
}

TEST_F(OrganAccuracy, BloodWithItsNormal) {
    feed("tissue.blood_color", s.organ.blood);
    feed("tissue.blood_normal", s.organ.blood_normal, [](double u, double v, int c) {
        const std::array<double, 4> n{0.2 * std::sin(8.0 * u), 0.25 * std::cos(6.0 * v), 0.95, 0.0};
        return static_cast<float>(n[static_cast<std::size_t>(c)]);
    });
    s.organ.blood_bump = 1.5;
    s.parameters["blood"] = {{"bump", 1.5}};
    expect("blood with its normal");
}

TEST_F(OrganAccuracy, BloodWithItsHeight) {
    feed("tissue.blood_color", s.organ.blood);
    feed("tissue.blood_height", s.organ.blood_height,
         [](double u, double v, int) { return static_cast<float>(0.8 + 0.8 * std::sin(7.0 * u) * v); });
    s.organ.blood_bump = 0.7;
    s.parameters["blood"] = {{"bump", 0.7}};
    expect("blood with its height");
}

TEST_F(OrganAccuracy, CutByAlphaAndByVertex) {
    s.parameters["cut"] = {{"map", file("cut.exr", s.organ.cut_map, [](double u, double v, int c) {
                                return c == 3 ? static_cast<float>(u < 0.5 ? 1.0 : 0.0) : wave(v, u, c);
                            })}};
    feed("tissue.blood_color", s.organ.blood);
    // The threshold is 0 and the mix of texels is above it up to the next texel: no pixel lies on the edge.
    expect("cut by the map's alpha");
    (void)s.expected();
    std::vector<float> scalar;
    for (const glm::dvec2& uv : s.organ.uvs) {
        scalar.push_back(static_cast<float>(uv.x + uv.y - 0.9137));
    }
    s.organ.cut.assign(scalar.begin(), scalar.end());
    HostValues values;
    values.set("cuts", scalar);
    s.parameters["cut"]["vertex_scalar"] = "cuts";
    expect("cut by the host's scalar", 0.0, &values);
}

TEST_F(OrganAccuracy, HintComesAndGoes) {
    s.parameters["hint"] = {{"map", file("hint.exr", s.organ.hint)}, {"strength", 0.8}, {"period_s", 2.0}};
    for (const double time_s : {0.3, 1.0}) {
        s.organ.hint_share = 0.8 * 0.5 * (1.0 - std::cos(std::numbers::pi * time_s));
        expect("hint at " + std::to_string(time_s) + " s", time_s);
    }
}

TEST_F(OrganAccuracy, Hematoma) {
    s.parameters["hematoma"] = {
        {"spots", {{{"centre", {5, -8, 3}}, {"radius", 14}}, {{"centre", {-12, -6, -9}}, {"radius", 9}}}},
        {"host_spots", "bruises"},
        {"colour", {0.2, 0.05, 0.1}},
        {"strength", 0.75}};
    s.organ.hematoma_colour = {0.2, 0.05, 0.1};
    s.organ.hematoma_strength = 0.75;
    s.organ.spots = {{5, -8, 3, 14}, {-12, -6, -9, 9}};
    expect("hematoma");
    HostValues values;
    std::vector<float> more;
    for (int i = 0; i < 700; ++i) {  // more than a row of the texture
        const std::array<float, 4> spot{static_cast<float>(i % 31) * 2.0F - 31.0F, -7.0F,
                                        static_cast<float>(i / 31) * 2.5F - 28.0F,
                                        0.4F + 0.001F * static_cast<float>(i)};
        more.insert(more.end(), spot.begin(), spot.end());
        s.organ.spots.emplace_back(spot[0], spot[1], spot[2], spot[3]);
    }
    values.set("bruises", more);
    expect("hematoma, 702 spots", 0.0, &values);
    s.parameters["hematoma"]["metric"] = "uv";
    s.parameters["hematoma"]["spots"] = {{{"centre", {0.4, 0.6, 0}}, {"radius", 0.25}}};
    s.organ.spots = {{0.4, 0.6, 0, 0.25}};
    s.organ.spots_in_uv = true;
    expect("hematoma in texture coordinates");
}

TEST_F(OrganAccuracy, EightLightsOfEveryKind) {
    s.parameters["lights"] = json::array();
    s.organ.lights.clear();
    const Frame frame = [&] {
        (void)s.render();
        return s.stage().renderer().still(0.0);
    }();
    const glm::dmat4 view = frame.eye().view;
    const std::array<const char*, 3> places{"camera", "world", "infinity"};
    for (int i = 0; i < 8; ++i) {
        const std::size_t kind = static_cast<std::size_t>(i) % 3;
        // The last one of the camera's lies behind the organ, which it does not light however slowly it
        // falls.
        const bool behind = i == 6;
        const glm::dvec3 position(7.0 * std::sin(2.0 * i), -40.0 + 3.0 * i,
                                  behind ? -130.0 : 8.0 * std::cos(3.0 * i));
        const glm::dvec3 colour(0.1 + 0.02 * i, 0.2, 0.25 - 0.02 * i);
        const double angular = behind ? 0.02 : 0.5 * i;
        const double falloff = kind == 2 ? 0.0 : 120.0 + 10.0 * i;
        const double glow = i == 1 ? 32.0 : 0.0;
        s.parameters["lights"].push_back({{"place", places[kind]},
                                          {"position", {position.x, position.y, position.z}},
                                          {"colour", {colour.x, colour.y, colour.z}},
                                          {"falloff_mm", falloff},
                                          {"angular", angular},
                                          {"glow_mm", glow},
                                          {"glow_per_mm2", 0.01}});
        glm::dvec3 place = position;
        if (kind == 1) {
            place = glm::dvec3(view * glm::dvec4(position, 1.0));
        } else if (kind == 2) {
            place = glm::dmat3(view) * position;
        }
        s.organ.lights.push_back({place, kind == 2, colour, falloff, angular, glow, 0.01});
        if (i == 3 || i == 7) {
            expect(std::to_string(i + 1) + " lights");
        }
    }
}

TEST_F(OrganAccuracy, Focus) {
    s.parameters["focus"] = {
        {"near_mm", 60}, {"focus_mm", 92}, {"far_mm", 125}, {"clamp_near", 0.6}, {"clamp_far", 0.7}};
    s.organ.focus = reference::Focus{60, 92, 125, 0.6, 0.7};
    expect("focus");
    s.camera["kind"] = "orthographic";
    s.camera["height_mm"] = 58;
    expect("focus, orthographic");
}

TEST_F(OrganAccuracy, Membrane) {
    // Bent so far that it is seen through twice.
    s.use_mesh(patch_obj({.cells = 14, .bend_mm = 40.0}));
    s.camera["eye_mm"] = {60, -70, 23};
    feed("organ.diffuse", s.organ.diffuse);  // which has no smaller copies for edges to be seen in
    s.organ.colour = glm::dvec3(1.0);
    use_membrane();
    expect("membrane");
    s.parameters["focus"] = {{"near_mm", 60}, {"focus_mm", 92}, {"far_mm", 125}};
    s.organ.focus = reference::Focus{60, 92, 125, 1.0, 1.0};
    expect("membrane with focus");
}

TEST_F(OrganAccuracy, MembraneWhoseMapHasHolesAndMore) {
    feed("organ.diffuse", s.organ.diffuse,
         [](double u, double v, int c) { return c == 3 ? 3.0F * wave(u, v, c) - 1.0F : wave(u, v, c); });
    s.organ.colour = glm::dvec3(1.0);
    use_membrane();
    expect("membrane, alpha from -1 to 2");
}

TEST_F(OrganAccuracy, MembraneOfOneSide) {
    s.use_mesh(patch_obj({.cells = 14, .bend_mm = 40.0}));
    s.camera["eye_mm"] = {60, -70, 23};
    use_membrane();
    const Image both = s.render();
    for (const char* faces : {"front", "back"}) {
        s.parameters["faces"] = faces;
        s.organ.front = std::string_view(faces) == "front";
        s.organ.back = !s.organ.front;
        const Image image = s.render();
        EXPECT_NE(image.data, both.data);
        const reference::Buffer wanted = s.expected();
        for (int c = 0; c < 4; ++c) {
            EXPECT_LE(deviation(image, wanted, c, c).max, bound) << faces << ", channel " << c;
        }
        EXPECT_GE(deviation(image, s.expected(), 0, 0).content, std::size_t{300}) << faces;
    }
}

TEST_F(OrganAccuracy, EverythingAtOnce) {
    s.parameters["diffuse_map"] = file("diffuse.exr", s.organ.diffuse);
    s.organ.colour = glm::dvec3(1.0);
    use_normal_map(0.4);
    use_energy();
    feed("tissue.blood_color", s.organ.blood);
    feed("tissue.blood_normal", s.organ.blood_normal, [](double u, double v, int c) {
        const std::array<double, 4> n{0.2 * std::sin(8.0 * u), 0.25 * std::cos(6.0 * v), 0.95, 0.0};
        return static_cast<float>(n[static_cast<std::size_t>(c)]);
    });
    s.parameters["cut"] = {{"map", file("cut.exr", s.organ.cut_map, [](double u, double v, int c) {
                                return c == 3 ? static_cast<float>(u + v < 0.6 ? 1.0 : 0.0) : wave(v, u, c);
                            })}};
    s.parameters["hint"] = {{"map", file("hint.exr", s.organ.hint)}, {"strength", 0.5}, {"period_s", 0}};
    s.organ.hint_share = 0.5;
    use_bruise();
    s.parameters["focus"] = {{"near_mm", 60}, {"focus_mm", 92}, {"far_mm", 125}};
    s.organ.focus = reference::Focus{60, 92, 125, 1.0, 1.0};
    expect("everything at once");
}

}  // namespace
}  // namespace viscera::test
