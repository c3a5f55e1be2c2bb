#include <cstdlib>
#include <cstring>
#include <random>

#include "tests/stress/volume_scene.h"

namespace viscera::test {
namespace {

using nlohmann::json;
using VolumeSoak = VolumeStress;

/// Random scenes about a volume, made from a seed.
class Dice {
  public:
    explicit Dice(unsigned seed) : random_(seed) {}

    [[nodiscard]] int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
    [[nodiscard]] bool once_in(int n) { return below(n) == 0; }
    [[nodiscard]] double between(double low, double high) {
        return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
    }
    [[nodiscard]] json place(double far) {
        return {between(-far, far), between(-far, far), between(-far, far)};
    }
    template <class T>
    [[nodiscard]] T one_of(std::initializer_list<T> all) {
        return all.begin()[below(static_cast<int>(all.size()))];
    }

    [[nodiscard]] Volume volume(int channels) {
        const glm::ivec3 dims(1 + below(9), 1 + below(9), 1 + below(9));
        Volume volume = constant_volume(dims, {between(0.2, 3.0), between(0.2, 3.0), between(0.2, 3.0)}, 0.0,
                                        one_of({ScalarType::u8, ScalarType::i16, ScalarType::f32}));
        volume.channels = channels;
        volume.voxels.resize(volume.voxels.size() * static_cast<std::size_t>(channels));
        for (std::byte& byte : volume.voxels) {
            byte = static_cast<std::byte>(below(256));  // floats become anything, no numbers among them
        }
        if (volume.type != ScalarType::f32) {
            volume.slope = one_of({1.0, -2.0, 0.01});
            volume.intercept = one_of({0.0, -1024.0});
        } else if (once_in(2)) {
            tame(volume);
        }
        return volume;
    }

    /// Few labels, none of them next to each other, some of them no whole numbers.
    [[nodiscard]] Volume labels() {
        const glm::ivec3 dims(1 + below(5), 1 + below(5), 1 + below(5));
        return make_volume(dims, {between(1, 4), between(1, 4), between(1, 4)}, [&](const glm::ivec3&) {
            return one_of({0.0, 1.0, 7.0, 40000.0, 2.5});
        });
    }

    [[nodiscard]] json parameters(int channels) {
        json p{{"function", one_of({"composite", "composite", "mip", "minip", "average", "xray", "isosurface",
                                    "accumulate", "density"})}};
        json& points = p["transfer_function"]["points"] = json::array();
        for (int i = below(5); i >= 0; --i) {
            points.push_back({{"value", between(-500.0, 500.0)},
                              {"colour", {between(0, 1), between(0, 1), between(0, 1)}},
                              {"opacity", one_of({0.0, 1.0, 0.3})}});
        }
        p["isosurface"]["values"] = {{{"value", between(-100, 300)}, {"opacity", between(0, 1)}}};
        p["sampling"] = {{"scheme", one_of({"midpoint", "gauss", "preintegrated", "cell"})},
                         {"step", one_of({0.1, 0.5, 3.0})},
                         {"skip", !once_in(4)},
                         {"jitter", one_of({"none", "hash", "blue_noise"})},
                         {"termination", one_of({0.0, 0.002})},
                         {"tolerance", one_of({0.0, 0.0, 0.05})},
                         {"filter", one_of({"nearest", "linear", "linear", "linear_fp32", "bspline",
                                            "bspline_fp32", "catmull_rom", "catmull_rom_fp32"})}};
        if (p["sampling"]["filter"].get<std::string>().starts_with("linear") && once_in(2)) {
            p["sampling"]["gradient"] = "precomputed";
        }
        p["transfer_function"]["interpolate"] = once_in(3);
        p["volume"]["storage"] = one_of({"automatic", "automatic", "atlas"});
        if (channels > 1 && p["function"] == "accumulate" && p["sampling"]["scheme"] != "preintegrated") {
            p["accumulate"]["channels"] = json::array();
            for (int i = 0; i < channels; ++i) {
                p["accumulate"]["channels"].push_back({{"threshold", {between(0, 0.5), between(0.5, 1)}}});
            }
        } else {
            p["volume"]["channel"] = below(channels);
        }
        if (once_in(3)) {
            p["crop"] = {{"first", {below(9), below(9), below(9)}}, {"size", {below(9), below(9), below(9)}}};
        }
        if (once_in(3)) {
            p["volume"]["placement"] = {{"rotate_deg", place(180)},
                                        {"scale", {between(-2, 2), 1, between(0.1, 2)}}};
        }
        if (once_in(3)) {
            p["clip_planes"] = {{{"point_mm", place(3)}, {"normal", {1, between(-1, 1), between(-1, 1)}}}};
        }
        if (once_in(3)) {
            p["shading"] = {{"enabled", true}, {"lights", {{{"position_mm", place(30)}}}}};
            if (once_in(2)) {
                p["shading"]["light_volume"] = {
                    {"shadow", one_of({0.0, 0.8})}, {"ambient_occlusion", 0.5}, {"resolution", 6}};
            }
        }
        if (once_in(4) && !p.contains("accumulate")) {
            p["transfer_function"]["gradient"] = {{{"gradient", 0}, {"factor", between(0, 1)}},
                                                  {{"gradient", 200}, {"factor", 1}}};
        }
        if (once_in(4)) {
            p["sub_volume"]["depth_mm"] = between(0, 5);
        }
        if (once_in(3)) {
            p["labels"] = {{"host", "labels"},
                           {"segments",
                            {{{"id", 7}, {"visible", false}},
                             {{"id", 40000}, {"colour", {1, 0, 0}}, {"opacity_factor", between(0, 9)}}}}};
            if (once_in(2) && !p.contains("accumulate")) {
                p["labels"]["segments"][1]["points"] = p["transfer_function"]["points"];
                p["labels"]["segments"][1]["points"][0]["value"] = between(-500, 500);
            }
        }
        if (once_in(4)) {
            p["overlay"] = {{"host", "overlay"}, {"strength", between(0, 1)}};
        }
        return p;
    }

    [[nodiscard]] json camera() {
        const double far = one_of({3.0, 10.0, 40.0});
        json made{{"eye_mm", {between(-far, far), between(-far, far), between(-far, far)}},
                  {"target_mm", place(2)},
                  {"up", {0.1, 0.2, 1}},
                  {"near_mm", 0.01},
                  {"far_mm", one_of({20.0, 1000.0})}};
        if (once_in(4)) {
            made["kind"] = "orthographic";
            made["height_mm"] = between(1, 30);
        }
        return made;
    }

  private:
    /// Numbers of ordinary size, some none.
    void tame(Volume& volume) {
        for (std::size_t at = 0; at < volume.voxels.size(); at += sizeof(float)) {
            const float value = once_in(20) ? std::numeric_limits<float>::quiet_NaN()
                                            : static_cast<float>(between(-500.0, 500.0));
            std::memcpy(volume.voxels.data() + at, &value, sizeof value);
        }
    }
    std::mt19937 random_;
};

/// VISCERA_SOAK_FRAMES: how many scenes (default 12), each with a few frames of changes.
TEST_F(VolumeSoak, RandomScenesStayFiniteAndSkippingChangesNothing) {
    const char* wanted = std::getenv("VISCERA_SOAK_FRAMES");
    const int scenes = wanted == nullptr ? 12 : std::atoi(wanted);
    for (int i = 0; i < scenes; ++i) {
        Dice dice(static_cast<unsigned>(1000 + i));
        SCOPED_TRACE("seed " + std::to_string(1000 + i));
        const int channels = dice.one_of({1, 1, 2, 3, 4});
        LiveVolume live(dice.volume(channels));
        LiveVolume labels(dice.labels());
        LiveVolume overlay(dice.volume(1));
        give("labels", &labels);
        give("overlay", &overlay);
        json parameters = dice.parameters(channels);
        const json view = dice.camera();
        SCOPED_TRACE(view.dump() + parameters.dump());
        (void)cast(live, parameters, view);
        for (int change = 0; change < 4; ++change) {
            const glm::ivec3 n = live.volume().grid.dims;
            const glm::ivec3 first(dice.below(n.x), dice.below(n.y), dice.below(n.z));
            const glm::ivec3 size(1 + dice.below(n.x - first.x), 1 + dice.below(n.y - first.y), 1);
            const std::size_t bytes =
                static_cast<std::size_t>(size.x * size.y * channels) * bytes_of(live.volume().type);
            live.update({first, size},
                        std::vector<std::byte>(bytes, static_cast<std::byte>(dice.below(120))));
            if (dice.once_in(4)) {
                live.replace(dice.volume(channels));
            }
            if (dice.once_in(3)) {
                labels.replace(dice.labels());
            }
            if (dice.once_in(4)) {
                overlay.replace(dice.volume(1));
            }
            const double value = dice.between(-500.0, 500.0);
            renderer().set_parameter("cast", "/transfer_function/points/0/value", value);
            parameters["transfer_function"]["points"][0]["value"] = value;
            (void)picture();
        }
        const Image changed = picture();
        const LiveVolume same(live.volume());
        const Image fresh = cast(same, parameters, view);
        if (parameters["sampling"].contains("gradient")) {  // kept ones have steps that others left behind
            expect_near(changed, fresh, 0.02, "as if it had always been so");
        } else {
            expect_same(changed, fresh, "as if it had always been so");
        }
        parameters["sampling"]["skip"] = !parameters["sampling"]["skip"].get<bool>();
        if (parameters["sampling"]["tolerance"] == 0.0) {
            expect_same(cast(same, parameters, view), fresh, "with and without skipping");
        }
        EXPECT_LE(renderer().asset_count(), 100U);
    }
}

}  // namespace
}  // namespace viscera::test
