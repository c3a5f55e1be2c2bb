#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "tests/tissue/energy_stage.h"

namespace viscera::test {
namespace {

using reference::Action;
using reference::Source;
using HostContact = EnergyStage::HostContact;

// llvmpipe's exp is off by 3.8e-6 of its value.
constexpr double exp_error = 3.8e-6;

/// The largest difference between what a stage holds and a function of the place.
double deviation(EnergyStage& stage, const std::function<double(const glm::dvec3&)>& expected, int step = 1) {
    double most = 0.0;
    std::size_t touched = 0;
    stage.each_texel(
        [&](const glm::dvec3& place, double e) {
            most = std::max(most, std::abs(e - expected(place)));
            touched += e != 0.0 ? 1 : 0;
        },
        step);
    EXPECT_GT(touched, 10U);
    return most;
}

TEST(CoagulateAccuracy, AStillContactGivesTheGaussianOfItsDose) {
    EnergyStage stage;
    const Source source{{17.3, 21.9, 0.4}, {17.3, 21.9, 0.4}, 3.0, 2.5};
    stage.contacts({{17.3, 21.9, 0.4, 3.0, 2.5}});
    stage.frame(0.0);
    EXPECT_EQ(stage.frame(0.125).status, PassStatus::reduced);
    EXPECT_LE(deviation(stage,
                        [&](const glm::dvec3& p) {
                            return reference::energy_after(0.0, std::span(&source, 1), p, 0.125, 1, 1.0);
                        }),
              exp_error * 0.375 + 1e-7);
}

TEST(CoagulateAccuracy, ManySourcesAreSummedAndCutOff) {
    EnergyStage stage;
    std::vector<Source> sources;
    std::vector<HostContact> contacts;
    const auto add = [&](const glm::dvec3& at, double power, double sigma) {
        sources.push_back({at, at, power, sigma});
        contacts.push_back({at.x, at.y, static_cast<double>(static_cast<float>(at.z)), power, sigma});
    };
    for (int i = 0; i < 30; ++i) {  // more than the published 21, some of them close together
        add({10.0 + 0.75 * (i % 7) * (i % 5), 12.0 + 1.5 * (i % 11), 0.1 * i}, 0.25 * (1 + i % 4),
            0.5 * (2 + i % 3));
    }
    // By themselves, the strongest neither first nor last.
    for (int i = 0; i < 3; ++i) {
        add({36.0 + 0.2 * i, 36.0, 0.0}, std::array{0.25, 0.3125, 0.1875}[static_cast<std::size_t>(i)], 0.75);
        add({4.0, 36.0 + 0.2 * i, 0.0}, std::array{0.5, 0.625, 0.375}[static_cast<std::size_t>(i)], 0.75);
    }
    stage.contacts(contacts);
    stage.frame(0.0);
    stage.frame(0.25);
    double most = 0.0;
    std::set<double> cut_at;
    stage.each_texel([&](const glm::dvec3& p, double e) {
        double sum = 0.0;
        double largest = 0.0;
        for (const Source& source : sources) {
            const double d = glm::distance(p, source.from);
            if (std::abs(d - reference::reach(source)) < 1e-4) {
                return;  // too close to tell whether it counts
            }
            if (d < reference::reach(source)) {
                sum += source.rate * 0.25 * std::exp(-d * d / (2.0 * source.sigma * source.sigma));
                largest = std::max(largest, source.rate * 0.25);
            }
        }
        if (sum > 1.01 * largest) {
            cut_at.insert(largest);
        }
        most = std::max(most, std::abs(e - std::min(sum, largest)));
    });
    EXPECT_LE(most, 30 * exp_error * 0.25);
    EXPECT_GE(cut_at.size(), 3U) << "sums are cut off at sources of unlike power";
}

TEST(CoagulateAccuracy, TheOrderOfTheSourcesDoesNotMatter) {
    std::vector<HostContact> contacts;
    for (int i = 0; i < 40; ++i) {
        contacts.push_back({10.0 + 0.51 * i, 20.0 + 3.3 * std::sin(i), 0.2, 0.1 + 0.01 * i,
                            1.5 + 0.1 * (i % 3), static_cast<Action>(i % 3)});
    }
    EnergyStage forwards;
    EnergyStage backwards;
    std::vector<std::byte> first;
    for (EnergyStage* stage : {&forwards, &backwards}) {
        stage->stage.make_current();
        stage->contacts(contacts);
        for (int i = 0; i < 4; ++i) {
            stage->frame(0.125 * i);
        }
        if (first.empty()) {
            first = stage->energy().data;
        }
        std::ranges::reverse(contacts);
    }
    EXPECT_TRUE(backwards.energy().data == first);
}

/// F13.
TEST(CoagulateAccuracy, AStrokeIsTheClosedForm) {
    constexpr double begin_x = 8.0;
    constexpr double y = 20.0;
    constexpr double length = 22.0;
    for (const auto& [speed, sigma, frames_per_second] :
         {std::tuple(20.0, 2.0, 30.0), std::tuple(120.0, 1.0, 15.0), std::tuple(40.0, 3.0, 240.0)}) {
        EnergyStage stage(nlohmann::json{{"gain", "normalised"}});
        // A power that leaves the whole stroke in the linear part.
        const double power = 0.4 * speed * sigma * std::sqrt(2.0 * std::numbers::pi);
        const auto frames = static_cast<int>(std::ceil(length / speed * frames_per_second));
        const double duration = length / speed;
        for (int i = 0; i <= frames; ++i) {
            const double time = duration * i / frames;
            stage.contacts({{begin_x + speed * time, y, 0.0, power, sigma}});
            stage.frame(time);
        }
        const double peak = reference::stroke_energy(power, speed, sigma, length, length / 2.0, 0.0);
        EXPECT_LE(deviation(stage,
                            [&, speed = speed, sigma = sigma](const glm::dvec3& p) {
                                return reference::stroke_energy(power, speed, sigma, length, p.x - begin_x,
                                                                p.y - y);
                            }),
                  1e-3 * peak)
            << speed << " mm/s at " << frames_per_second << " Hz";
    }
}

/// Contacts that move from key to key, 15 a second, in three lanes that do not reach each other: one cuts,
/// and burns what it has cut on the way back; the others go beyond the thresholds of their actions.
void play(EnergyStage& stage, int frames_per_key, std::vector<std::vector<Source>>* steps) {
    const auto key = [](int k) {
        const bool back = k > 3;
        return std::vector<HostContact>{
            {back ? 27.0 - k : 9.0 + 5.0 * k, 8.0, 0.3, 12.0, 1.0,
             back ? Action::coagulate : Action::dissect},
            {8.0 + 3.0 * k, 20.0 + std::sin(k), 0.0, 12.0, 1.0, Action::ultrasound},
            {28.0 - 2.0 * k, 32.5, 0.5, 9.0, 1.0, Action::coagulate},
            {34.0, 8.0 + 3.0 * k, 0.0, 3.0, 1.0, Action::coagulate},
            {35.0, 8.0 + 3.0 * k, 0.0, 4.0, 1.0, Action::coagulate}};
    };
    constexpr int keys = 7;
    for (int i = 0; i <= keys * frames_per_key; ++i) {
        // What a contact does in an interval, it does in all its frames.
        const int k = (i + frames_per_key - 1) / frames_per_key;
        const std::vector<HostContact> from = key(std::max(k - 1, 0));
        const std::vector<HostContact> to = key(k);
        const double share = 1.0 - static_cast<double>(k * frames_per_key - i) / frames_per_key;
        std::vector<HostContact> now = to;
        std::vector<float> places;
        std::vector<Source> step;
        for (std::size_t c = 0; c < now.size(); ++c) {
            const glm::dvec3 a(from[c].x, from[c].y, from[c].z);
            const glm::dvec3 b(to[c].x, to[c].y, to[c].z);
            const glm::dvec3 at = glm::mix(a, b, share);
            const glm::dvec3 before = glm::mix(a, b, share - 1.0 / frames_per_key);
            now[c].x = at.x;
            now[c].y = at.y;
            now[c].z = at.z;
            places.insert(places.end(), {static_cast<float>(before.x), static_cast<float>(before.y),
                                         static_cast<float>(before.z)});
            step.push_back({before, at, to[c].power, to[c].sigma, to[c].action});
        }
        stage.contacts(now);
        stage.values.set("tissue.contacts_from", places);
        stage.frame(static_cast<double>(i) / (15.0 * frames_per_key));
        if (steps != nullptr && i > 0) {
            steps->push_back(step);
        }
    }
}

TEST(CoagulateAccuracy, TheFrameRateDoesNotMatter) {
    EnergyStage slow;
    EnergyStage fast;
    slow.stage.make_current();
    std::vector<std::vector<Source>> steps;
    play(slow, 1, &steps);
    std::vector<double> at_15;
    slow.each_texel([&](const glm::dvec3&, double e) { at_15.push_back(e); });

    fast.stage.make_current();
    play(fast, 16, nullptr);
    double most = 0.0;
    double lowest = 0.0;
    double highest = 0.0;
    std::size_t i = 0;
    fast.each_texel([&](const glm::dvec3&, double e) {
        most = std::max(most, std::abs(e - at_15[i++]));
        lowest = std::min(lowest, e);
        highest = std::max(highest, e);
    });
    RecordProperty("deviation", std::to_string(most));
    EXPECT_LE(most, 1e-4);

    slow.stage.make_current();
    double off = 0.0;
    slow.each_texel(
        [&](const glm::dvec3& p, double e) {
            double expected = 0.0;
            for (const std::vector<Source>& step : steps) {
                expected = reference::energy_after(expected, step, p, 1.0 / 15.0, 2000, 1.0);
            }
            off = std::max(off, std::abs(e - expected));
        },
        4);
    RecordProperty("off the rules", std::to_string(off));
    // A step of the reference beyond a threshold, and the first one after a cut, which burns without adding.
    EXPECT_LE(off, 2.0 * 12.0 / 15.0 / 2000 + 1e-4);
    EXPECT_LT(lowest, -0.2) << "something was cut";
    EXPECT_GT(highest, 0.9) << "something was burnt beyond every threshold";
}

/// The published rules, taken in steps so short that a threshold is crossed at its place.
TEST(CoagulateAccuracy, LongFramesDoWhatShortStepsOfThePublishedRulesDo) {
    for (const Action action : {Action::coagulate, Action::ultrasound, Action::dissect}) {
        EnergyStage stage;
        // Cut on the left, burnt on the right, then the action over both.
        const std::vector<std::vector<Source>> steps{
            {{{14, 20, 0}, {14, 22, 0}, 3.0, 1.2, Action::dissect},
             {{28, 20, 0}, {28, 20, 0}, 3.0, 1.2, Action::coagulate}},
            {{{12, 20, 0}, {30, 20, 0}, 9.0, 1.5, action}}};
        stage.frame(0.0);
        for (std::size_t s = 0; s < steps.size(); ++s) {
            std::vector<HostContact> contacts;
            std::vector<float> places;
            for (const Source& source : steps[s]) {
                contacts.push_back({source.to.x, source.to.y, 0.0, source.rate, source.sigma, source.action});
                places.insert(places.end(),
                              {static_cast<float>(source.from.x), static_cast<float>(source.from.y), 0.0F});
            }
            stage.contacts(contacts);
            stage.values.set("tissue.contacts_from", places);
            stage.frame(0.25 * static_cast<double>(s + 1));
        }
        // Where cut tissue is hardly reached, the sign it ends with hangs on where a Gaussian is taken to
        // end.
        double most = 0.0;
        stage.each_texel(
            [&](const glm::dvec3& p, double e) {
                double expected = 0.0;
                for (const std::vector<Source>& step : steps) {
                    expected = reference::energy_after(expected, step, p, 0.25, 4000, 1.0);
                }
                most = std::max(most, std::abs(e - expected));
            },
            3);
        // A step beyond the threshold, and its half at a texel.
        EXPECT_LE(most, 9.0 * 0.25 / 4000 + 1e-4) << static_cast<int>(action);
    }
}

TEST(CoagulateAccuracy, ASpotIsRoundOnTheOrganNotInTheTexture) {
    Plane stretched;
    stretched.stretch = 2.0;
    EnergyStage stage({}, stretched, "stretched");
    const Source source{{20, 20, 0}, {20, 20, 0}, 4.0, 3.0};
    stage.contacts({{20, 20, 0, 4.0, 3.0}});
    stage.frame(0.0);
    stage.frame(0.125);
    EXPECT_LE(deviation(stage,
                        [&](const glm::dvec3& p) {
                            return reference::energy_after(0.0, std::span(&source, 1), p, 0.125, 1, 1.0);
                        }),
              exp_error * 0.5 + 1e-7);
}

TEST(CoagulateAccuracy, ASeamIsNotSeen) {
    Plane cut;
    cut.seam = true;
    EnergyStage stage({}, cut, "seam");
    // Along the seam, on it, and across it.
    const std::vector<Source> sources{{{20.2, 8, 0}, {20.2, 20, 0}, 4.0, 2.0},
                                      {{12, 26, 0}, {29, 24, 0}, 5.0, 1.5}};
    stage.contacts({{20.2, 20, 0, 4.0, 2.0}, {29, 24, 0, 5.0, 1.5}});
    stage.values.set("tissue.contacts_from", std::vector<float>{20.2F, 8, 0, 12, 26, 0});
    stage.frame(0.0);
    stage.frame(0.25);
    double peak = 0.0;
    const double most = deviation(stage, [&](const glm::dvec3& p) {
        double sum = 0.0;
        for (const Source& s : sources) {
            sum += s.rate * 0.25 * reference::mean_gaussian(s.from, s.to, s.sigma, p);
        }
        peak = std::max(peak, sum);
        return sum;
    });
    EXPECT_LT(peak, 0.5) << "in the linear part";
    EXPECT_LE(most, 1e-5 * peak);
    // In the gutters stands what the surface beyond the seam has.
    const Image places = stage.position();
    const Image energies = stage.energy();
    std::size_t gutters = 0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            if (places.at(x, y, 3) != 0.5F) {
                continue;
            }
            const glm::dvec3 p(places.at(x, y, 0), places.at(x, y, 1), places.at(x, y, 2));
            double sum = 0.0;
            for (const Source& s : sources) {
                sum += s.rate * 0.25 * reference::mean_gaussian(s.from, s.to, s.sigma, p);
            }
            EXPECT_NEAR(static_cast<double>(energies.at(x, y, 0)), sum, 1e-5 * peak);
            gutters += sum > 0.05 ? 1 : 0;
        }
    }
    EXPECT_GT(gutters, 20U);
}

TEST(CoagulateAccuracy, InUvDistancesAreThoseOfTheTexture) {
    EnergyStage stage(nlohmann::json{{"metric", "uv"}, {"mesh", nullptr}});
    stage.contacts({{0.4, 0.6, 0.0, 2.0, 0.03}});
    stage.frame(0.0);
    stage.frame(0.125);
    const Image energies = stage.energy();
    double most = 0.0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            const double d2 = std::pow((x + 0.5) / 128 - 0.4, 2) + std::pow((y + 0.5) / 128 - 0.6, 2);
            const double expected = 0.25 * std::exp(-d2 / (2 * 0.03 * 0.03));
            most = std::max(most, std::abs(static_cast<double>(energies.at(x, y, 0)) - expected));
        }
    }
    EXPECT_LE(most, exp_error * 0.25 + 1e-7);
}

}  // namespace
}  // namespace viscera::test
