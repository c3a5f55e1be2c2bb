// Accumulation of volumes that hold colours, beside its double-precision reference.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/reference/volume_lattice.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

constexpr int colours_side = 24;

/// Smooth blobs of colour in black, 8 bits a channel; the least and greatest value are 0 and 255.
Volume blobs(int channels) {
    Volume volume{.grid = {.dims = glm::ivec3(colours_side),
                           .spacing_mm = glm::dvec3(2.0),
                           .origin_mm = glm::dvec3(-1.0 * (colours_side - 1))},
                  .type = ScalarType::u8,
                  .channels = channels,
                  .source = "blobs"};
    std::mt19937 random(5);
    const auto unit = [&] { return static_cast<double>(random() >> 8U) / 16777216.0; };
    std::vector<glm::dvec3> centres;
    for (int c = 0; c < channels; ++c) {
        centres.push_back(double{colours_side} * (0.3 + 0.4 * glm::dvec3(unit(), unit(), unit())));
    }
    for (int z = 0; z < colours_side; ++z) {
        for (int y = 0; y < colours_side; ++y) {
            for (int x = 0; x < colours_side; ++x) {
                for (const glm::dvec3& centre : centres) {
                    const double r = glm::length(glm::dvec3(x, y, z) - centre) / 8.0;
                    const double value = r < 1.0 ? 255.0 * (1.0 - r) * (0.8 + 0.2 * unit()) : 0.0;
                    volume.voxels.push_back(static_cast<std::byte>(std::lround(value)));
                }
            }
        }
    }
    volume.voxels[0] = std::byte{255};
    return volume;
}

class ColourAccumulation : public testing::Test {
  protected:
    /// Slabs as long as the length that opacities are for.
    static nlohmann::json parameters(const nlohmann::json& channels) {
        const double slab_mm = 0.5;
        const double diagonal_mm = std::sqrt(3.0) * 2.0 * colours_side;
        return {{"function", "accumulate"},
                {"accumulate",
                 {{"opacity", 1.5},
                  {"samples", diagonal_mm / slab_mm},
                  {"brightness", 0.1},
                  {"contrast", 0.8},
                  {"channels", channels}}},
                {"sampling",
                 {{"scheme", "midpoint"}, {"step", 0.25}, {"termination", 0.0}, {"filter", "linear_fp32"}}}};
    }
    static nlohmann::json channels(int count) {
        nlohmann::json list = nlohmann::json::array();
        for (int c = 0; c < count; ++c) {
            list.push_back(nlohmann::json::object());
        }
        return list;
    }
    using Look = decltype(reference::Accumulate::look);
    /// Pixels that differ from the reference by more than `limit`. `look_of`: of a ray.
    static int off(const Shot& shot, const Volume& volume, const nlohmann::json& p, double limit,
                   reference::Filter filter = reference::Filter::trilinear,
                   const std::function<Look(const reference::Ray&)>& look_of = {}) {
        const std::vector<reference::Field> fields = fields_of(volume, filter);
        reference::Accumulate rule{.opacity = p["accumulate"]["opacity"],
                                   .samples = p["accumulate"]["samples"],
                                   .brightness = 0.1,
                                   .contrast = 0.8};
        for (int c = 0; c < volume.channels; ++c) {
            const nlohmann::json& channel = p["accumulate"]["channels"][static_cast<std::size_t>(c)];
            if (channel.contains("threshold")) {
                rule.low[c] = channel["threshold"][0];
                rule.high[c] = channel["threshold"][1];
            }
        }
        int count = 0;
        int lit = 0;
        for (int y = 0; y < shot.image.height; ++y) {
            for (int x = 0; x < shot.image.width; ++x) {
                const reference::Ray ray = shot.ray(x, y);
                const auto interval = reference::intersect(ray, fields[0].texture_to_world());
                rule.look = look_of ? look_of(ray) : Look();
                const glm::dvec4 wanted =
                    interval ? reference::accumulate(fields, ray, *interval, 0.5, rule) : glm::dvec4(0.0);
                const glm::dvec4 miss = glm::abs(shot.at(x, y) - wanted);
                count += !(std::max({miss.r, miss.g, miss.b, miss.a}) <= limit) ? 1 : 0;
                lit += wanted.a > 0.05 ? 1 : 0;
            }
        }
        EXPECT_GT(lit, 100);
        return count;
    }

    /// The channels as shares of their range.
    static std::vector<reference::Field> fields_of(const Volume& volume, reference::Filter filter) {
        std::vector<reference::Field> fields;
        for (int c = 0; c < volume.channels; ++c) {
            std::vector<double> shares = reference::decoded(volume, c);
            for (double& share : shares) {
                share /= 255.0;
            }
            fields.emplace_back(volume.grid.dims, std::move(shares), filter,
                                reference::texture_to_world_of(volume.grid));
        }
        return fields;
    }
    /// The picture of a volume with others beside it.
    Shot cast_with(const LiveVolume& volume, std::span<const HostVolume> others, nlohmann::json p) {
        p["volume"]["host"] = "host";
        std::vector<HostVolume> given(others.begin(), others.end());
        given.push_back({"host", &volume});
        Stage& stage = stage_.stage();
        stage.make_current();
        stage.load(mixed_scene(nlohmann::json::array(), p, to_json(look_), 64, 64));
        stage.renderer().keep({"volume.colour"});
        Frame frame = stage.renderer().still(0.0);
        frame.volumes = given;
        stage.renderer().render(frame);
        return {stage.renderer().read("volume.colour"), frame.eye()};
    }

    VolumeStage stage_;
    test::Look look_{.eye_mm = {110, -150, 60}, .fov_deg = 22};
};

TEST_F(ColourAccumulation, IsThatOfDoublePrecision) {
    for (const int count : {2, 3, 4}) {
        const LiveVolume volume(blobs(count));
        const nlohmann::json p = parameters(channels(count));
        // The last slab's opacity is a power here and a share in the reference: a^2 / 8 apart, 1e-5.
        EXPECT_EQ(off(stage_.cast(volume, p, look_), volume.volume(), p, 2e-5), 0) << count << " channels";
    }
}

TEST_F(ColourAccumulation, DropsWhatLeavesTheThresholdOfAnyChannel) {
    for (const int count : {2, 3, 4}) {
        const LiveVolume volume(blobs(count));
        nlohmann::json list = channels(count);
        list[0]["threshold"] = {0.0, 0.4};
        list[static_cast<std::size_t>(count - 1)]["threshold"] = {0.15, 1.0};
        const nlohmann::json p = parameters(list);
        // A sample within a rounding of a threshold may fall on either side of it.
        EXPECT_LE(off(stage_.cast(volume, p, look_), volume.volume(), p, 2e-5), 3) << count << " channels";
    }
}

TEST_F(ColourAccumulation, OfGreyIsThatOfItsOneChannel) {
    const Volume grey = blobs(1);
    Volume rgb = grey;
    rgb.channels = 3;
    rgb.voxels.clear();
    for (const std::byte value : grey.voxels) {
        rgb.voxels.insert(rgb.voxels.end(), 3, value);
    }
    nlohmann::json one = parameters(nlohmann::json::array());
    one["transfer_function"] = {{"interpolate", true}};
    const Shot wanted = stage_.cast(LiveVolume(grey), one, look_);
    const Shot shown = stage_.cast(LiveVolume(rgb), parameters(channels(3)), look_);
    EXPECT_LE(difference(wanted.image, shown.image).max, 1e-5);
}

TEST_F(ColourAccumulation, SkippingStorageAndSchemeChangeLittleOrNothing) {
    const LiveVolume volume(blobs(4));
    nlohmann::json list = channels(4);
    list[1]["threshold"] = {0.1, 0.9};
    const LiveVolume labels(byte_volume(10, 5.0, [](const glm::dvec3& p) { return p.x < 3 ? 1.0 : 0.0; }));
    const HostVolume given{"labels", &labels};
    for (const char* filter : {"nearest", "linear", "linear_fp32", "bspline", "catmull_rom_fp32"}) {
        for (const char* scheme : {"midpoint", "gauss", "cell"}) {
            // Software renderers take seconds to compile the largest of these shaders.
            const std::string_view name(filter);
            if ((name == "bspline" || name == "catmull_rom_fp32") && std::string_view(scheme) != "midpoint") {
                continue;
            }
            nlohmann::json p = parameters(list);
            p["sampling"]["filter"] = filter;
            p["sampling"]["scheme"] = scheme;
            if (std::string_view(scheme) == "gauss") {
                p["shading"] = {{"enabled", true},
                                {"lights", {{{"direction", {0, 0, 1}}}}},
                                {"light_volume", {{"shadow", 0.5}}}};
                p["labels"] = {{"host", "labels"}, {"segments", {{{"id", 1}, {"opacity_factor", 0.3}}}}};
            }
            const Shot skipped = cast_with(volume, std::span(&given, 1), p);
            p["sampling"]["skip"] = false;
            EXPECT_TRUE(same_bits(skipped, cast_with(volume, std::span(&given, 1), p)))
                << filter << ' ' << scheme;
            p["volume"]["storage"] = "atlas";
            const double off =
                difference(skipped.image, cast_with(volume, std::span(&given, 1), p).image).max;
            const bool by_texture_unit =
                std::string_view(filter) == "linear" || std::string_view(filter) == "bspline";
            EXPECT_LE(off, by_texture_unit ? 1e-2 : 0.0) << filter << ' ' << scheme;
        }
    }
}

TEST_F(ColourAccumulation, CubicFiltersAreThoseOfDoublePrecision) {
    using reference::Filter;
    struct Kind {
        const char* name;
        bool prefilter;
        Filter reference;
    };
    const LiveVolume volume(blobs(4));
    for (const Kind& kind :
         {Kind{"bspline_fp32", true, Filter::bspline_prefiltered}, Kind{"bspline", false, Filter::bspline},
          Kind{"catmull_rom_fp32", true, Filter::catmull_rom},
          Kind{"catmull_rom", true, Filter::catmull_rom}}) {
        nlohmann::json p = parameters(channels(4));
        p["sampling"]["filter"] = kind.name;
        p["sampling"]["prefilter"] = kind.prefilter;
        EXPECT_LE(off(stage_.cast(volume, p, look_), volume.volume(), p, 2e-5, kind.reference), 0)
            << kind.name;
    }
}

TEST_F(ColourAccumulation, LabelsTintAndThin) {
    const LiveVolume labels(byte_volume(12, 4.0, [](const glm::dvec3& p) { return p.x < 1 ? 3.0 : 9.0; }));
    const HostVolume given{"labels", &labels};
    for (const int count : {2, 3}) {
        const LiveVolume volume(blobs(count));
        nlohmann::json p = parameters(channels(count));
        const auto shown = [&](double factor) {
            p["labels"] = {{"host", "labels"},
                           {"segments",
                            {{{"id", 3}, {"opacity_factor", factor}},
                             {{"id", 9}, {"colour", {0.2, 0.9, 0.3}}, {"colour_weight", 0.5}}}}};
            return cast_with(volume, std::span(&given, 1), p);
        };
        const auto look = [](double factor) {
            return [=](const reference::Ray&) -> Look {
                return [=](glm::dvec3& colour, double& opacity, const glm::dvec3& p_mm) {
                    const bool low = p_mm.x < 0.0;  // where voxels of the labels meet
                    colour = low ? colour : glm::mix(colour, glm::dvec3(0.2, 0.9, 0.3), 0.5);
                    opacity = low ? 1.0 - std::pow(1.0 - opacity, factor) : opacity;
                };
            };
        };
        // Samples within a rounding of the border may fall to either side.
        EXPECT_LE(off(shown(0.4), volume.volume(), p, 2e-5, reference::Filter::trilinear, look(0.4)), 3);
        EXPECT_LE(off(shown(0.0), volume.volume(), p, 2e-5, reference::Filter::trilinear, look(0.0)), 3);
    }
}

TEST_F(ColourAccumulation, ShadingTakesTheGradientOfTheOpacity) {
    for (const int count : {2, 3, 4}) {
        const LiveVolume volume(blobs(count));
        const std::vector<reference::Field> fields = fields_of(volume.volume(), reference::Filter::trilinear);
        for (const char* gradient : {"central", "precomputed"}) {
            nlohmann::json p = parameters(channels(count));
            p["sampling"]["gradient"] = gradient;
            p["shading"] = {{"enabled", true},
                            {"lighting", {{"ambient", 0.3}, {"diffuse", 0.7}, {"specular", 0.0}}}};
            const auto look_of = [&](const reference::Ray& ray) -> Look {
                return [&, ray](glm::dvec3& colour, double&, const glm::dvec3& p_mm) {
                    const glm::dvec3 t = fields[0].world_to_texture() * glm::dvec4(p_mm, 1.0);
                    glm::dvec3 slope(0.0);
                    for (int c = count == 3 ? 0 : count - 1; c < count; ++c) {
                        slope += fields[static_cast<std::size_t>(c)].central_difference(t);
                    }
                    slope = fields[0].to_world_gradient(slope);
                    const double length = glm::length(slope);
                    const double facing =
                        length > 1e-9 ? std::abs(glm::dot(slope, ray.direction)) / length : 0.0;
                    colour *= 0.3 + 0.7 * facing;
                };
            };
            const Shot shot = stage_.cast(volume, p, look_);
            // The mean of three channels is rounded to 1/65535, kept gradients to 16 bits.
            const double limit = std::string_view(gradient) == "central" ? 1e-4 : 1e-3;
            EXPECT_EQ(off(shot, volume.volume(), p, limit, reference::Filter::trilinear, look_of), 0)
                << count << ' ' << gradient;
        }
    }
}

/// What is hidden throws no shadow, and the overlay's hue is over the colours.
TEST_F(ColourAccumulation, LightAndOverlay) {
    const LiveVolume volume(blobs(3));
    const LiveVolume labels(byte_volume(12, 4.0, [](const glm::dvec3& p) { return p.z > 4 ? 1.0 : 0.0; }));
    const LiveVolume hue(byte_volume(4, 12.0, [](const glm::dvec3&) { return 100.0; }));
    const std::array<HostVolume, 2> given{HostVolume{"labels", &labels}, HostVolume{"hue", &hue}};
    nlohmann::json p = parameters(channels(3));
    p["accumulate"]["opacity"] = 20.0;
    p["shading"]["lights"] = {{{"direction", {0, 0, 1}}}};
    p["shading"]["light_volume"] = {{"shadow", 1.0}, {"resolution", 24}};
    const Shot dark = cast_with(volume, given, p);
    p["labels"] = {{"host", "labels"}, {"segments", {{{"id", 1}, {"visible", false}}}}};
    const Shot lit = cast_with(volume, given, p);
    p["shading"].erase("light_volume");
    const Shot plain = cast_with(volume, given, p);
    // Seen from below nothing that is hidden lies between the eye and what it shadows.
    const auto brightness = [](const Shot& shot) {
        double sum = 0.0;
        for (int y = 0; y < 28; ++y) {
            for (int x = 0; x < 64; ++x) {
                sum += shot.at(x, y).r;
            }
        }
        return sum;
    };
    EXPECT_GT(brightness(lit), 1.1 * brightness(dark));
    EXPECT_GT(brightness(plain), brightness(lit));
    p["overlay"] = {{"host", "hue"},
                    {"points",
                     {{{"value", 0}, {"colour", {0, 0, 1}}, {"opacity", 1}},
                      {{"value", 200}, {"colour", {0, 0, 1}}, {"opacity", 1}}}}};
    const Shot blue = cast_with(volume, given, p);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            EXPECT_LE(std::max(blue.at(x, y).r, blue.at(x, y).g), 1e-6);
            EXPECT_EQ(blue.at(x, y).a, plain.at(x, y).a);
        }
    }
}

TEST_F(ColourAccumulation, FollowsALiveVolume) {
    LiveVolume volume(blobs(3));
    int at = 8;
    struct Kind {
        const char* filter;
        bool shaded;
        double limit;
    };
    // A change is solved again within its reach; kept gradients may be scaled by another greatest one.
    for (const auto& [filter, shaded, limit] :
         {Kind{"linear_fp32", false, 0.0}, Kind{"linear_fp32", true, 1e-3}, Kind{"bspline", false, 1e-6}}) {
        nlohmann::json p = parameters(channels(3));
        p["sampling"]["filter"] = filter;
        if (shaded) {
            p["shading"] = {{"enabled", true}};
            p["sampling"]["gradient"] = "precomputed";
        }
        const Shot before = stage_.cast(volume, p, look_);
        const std::vector<std::byte> voxels(4 * 4 * 4 * 3, std::byte{200});
        volume.update({glm::ivec3(at += 2), glm::ivec3(4)}, voxels);
        const Shot after = stage_.cast_again(volume, before.view, glm::ivec2(64));
        EXPECT_FALSE(same_bits(before, after)) << filter;
        const Shot anew = stage_.cast(LiveVolume(volume.volume()), p, look_);
        EXPECT_LE(difference(after.image, anew.image).max, limit) << filter;
    }
}

TEST_F(ColourAccumulation, RefusesWhatTakesAValue) {
    const LiveVolume volume(blobs(3));
    EXPECT_THROW((void)stage_.cast(volume, parameters(channels(4)), look_), Error);
    EXPECT_THROW((void)stage_.cast(volume, parameters(channels(1)), look_), Error);
    const nlohmann::json own{{"host", "labels"}, {"segments", {{{"id", 1}, {"points", {{{"value", 0}}}}}}}};
    for (const auto& [where, value] :
         std::map<std::string, nlohmann::json>{{"/sampling/scheme", "preintegrated"},
                                               {"/labels", own},
                                               {"/transfer_function/gradient", {{{"gradient", 1}}}}}) {
        nlohmann::json p = parameters(channels(3));
        p[nlohmann::json::json_pointer(where)] = value;
        EXPECT_THROW((void)stage_.cast(volume, p, look_), Error) << where;
    }
}

}  // namespace
}  // namespace viscera::test
