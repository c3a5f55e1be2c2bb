#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/schedule.h"
#include "tests/core/random_graph.h"

// What schedules are held against: a machine that draws by them in columns of numbers, and an oracle that
// draws everything.

namespace viscera::test {

inline std::size_t fold(std::size_t hash, std::size_t value) {
    return std::hash<std::string>()(std::to_string(hash) + "," + std::to_string(value));
}

// Pictures of four columns, each 16 pixels wide, of which updates touch some.
inline constexpr std::size_t columns = 4;
inline constexpr int column_width = 16;

inline PixelRect column(std::size_t i) {
    return {static_cast<int>(i) * column_width, 0, column_width, 64};
}

/// Pixel values that tell how they came about. Two are equal only when the same things were drawn.
using Picture = std::array<std::size_t, columns>;
inline constexpr Picture garbage{7, 7, 7, 7};

inline Picture uniform(std::size_t value) {
    Picture picture;
    picture.fill(value);
    return picture;
}

inline Picture cleared(const PlanContent& content) {
    return uniform(
        fold(static_cast<std::size_t>(content.clear[0] * 16.0F), static_cast<std::size_t>(content.format)));
}

inline std::size_t fold(std::size_t hash, const Picture& picture) {
    for (const std::size_t value : picture) {
        hash = fold(hash, value);
    }
    return hash;
}

/// Of what lies below, an update leaves all but the columns it touches.
inline Picture drawn_over(const Picture& below, const PassWork& work, std::size_t value) {
    Picture picture = below;
    for (std::size_t i = 0; i < columns; ++i) {
        if (!work.update || work.touched.covers(column(i))) {
            picture[i] = value + i;
        }
    }
    return picture;
}

inline bool leaves_empty(const PassWork& work, std::size_t binding) {
    return work.idle || ((work.empty_bindings >> binding) & 1U) != 0;
}

/// What the pictures of one frame are when every content has a texture of its own and nothing is skipped.
class Oracle {
  public:
    std::vector<Picture> frame(const Plan& plan, const std::vector<PassWork>& work,
                               const std::vector<std::size_t>& noise, Picture host) {
        std::vector<Picture> pictures(plan.contents.size(), garbage);
        for (std::size_t c = 0; c < plan.contents.size(); ++c) {
            if (plan.contents[c].imported && !plan.contents[c].writer) {
                pictures[c] = host;
            }
        }
        for (const PlanHistory& history : plan.history) {
            const auto last = last_.find(history.target);
            pictures[history.previous] =
                last == last_.end() ? cleared(plan.contents[history.previous]) : last->second;
        }
        for (std::size_t p = 0; p < plan.passes.size(); ++p) {
            if (plan.passes[p].live) {
                draw(plan, p, work[p], noise[p], pictures);
            }
        }
        for (const PlanHistory& history : plan.history) {
            last_[history.target] = pictures[history.current.value()];
        }
        return pictures;
    }

  private:
    static void draw(const Plan& plan, std::size_t p, const PassWork& work, std::size_t noise,
                     std::vector<Picture>& pictures) {
        std::size_t input = fold(p, fold(work.key, noise));
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::read || b.access == Access::previous)) {
                input = fold(input, pictures[*b.content]);
            } else if (b.content && b.access == Access::modify) {
                input = fold(input, pictures[*plan.contents[*b.content].modifies]);
            }
        }
        for (std::size_t i = 0; i < plan.passes[p].bindings.size(); ++i) {
            const PlanBinding& b = plan.passes[p].bindings[i];
            if (!b.content || b.access == Access::read || b.access == Access::previous) {
                continue;
            }
            const PlanContent& content = plan.contents[*b.content];
            const auto stand_in = content.modifies ? content.modifies : content.passthrough;
            const Picture below = stand_in ? pictures[*stand_in] : cleared(content);
            pictures[*b.content] =
                leaves_empty(work, i) ? below : drawn_over(below, work, fold(input, *b.content));
        }
    }

    std::map<std::string, Picture> last_;
};

/// An executor whose textures hold pictures; checks whatever it reads against the oracle's.
class Machine {
  public:
    void frame(const Plan& plan, const Schedule& schedule, const std::vector<PassWork>& work,
               const std::vector<std::size_t>& noise, Picture host, const std::vector<Picture>& expected) {
        textures_.resize(plan.textures.size(), garbage);
        host_ = host;
        drawn = 0;
        for (std::size_t p = 0; p < plan.passes.size(); ++p) {
            if (schedule.passes()[p].draws()) {
                draw(plan, schedule, p, work[p], noise[p], expected);
                ++drawn;
            }
        }
        for (std::size_t i = 0; i < plan.outputs.size(); ++i) {
            settle(plan, schedule.outputs()[i]);
        }
        for (std::size_t i = 0; i < plan.outputs.size(); ++i) {
            EXPECT_EQ(at(plan, schedule.outputs()[i].content), expected[plan.outputs[i].content]) << "output";
            if (plan.contents[plan.outputs[i].content].imported) {
                EXPECT_EQ(host_, expected[plan.outputs[i].content]) << "output in the host's texture";
            }
        }
        for (std::size_t i = 0; i < plan.history.size(); ++i) {
            const HistoryStep& step = schedule.history()[i];
            settle(plan, step.settlement);
            if (step.swap) {
                std::swap(at(plan, plan.history[i].previous), at(plan, *plan.history[i].current));
            }
        }
    }

    std::size_t drawn = 0;
    std::size_t copied_whole = 0;
    std::size_t copied_parts = 0;
    std::size_t copied_columns = 0;

  private:
    Picture& at(const Plan& plan, std::size_t content) {
        const PlanContent& c = plan.contents[content];
        return c.imported ? host_ : textures_.at(c.texture.value());
    }

    void settle(const Plan& plan, const Settlement& s) {
        if (s.action == Settlement::Action::clear) {
            at(plan, s.content) = cleared(plan.contents[s.source]);
        } else if (s.action == Settlement::Action::copy) {
            at(plan, s.content) = at(plan, s.source);
            ++copied_whole;
        } else if (s.action == Settlement::Action::copy_parts) {
            for (std::size_t i = 0; i < columns; ++i) {
                if (s.parts.covers(column(i))) {
                    at(plan, s.content)[i] = at(plan, s.source)[i];
                    ++copied_columns;
                }
            }
            ++copied_parts;
        }
    }

    Picture sample(const Plan& plan, const Schedule& schedule, std::size_t content) {
        const ContentState& state = schedule.contents()[content];
        return state.empty ? cleared(plan.contents[state.holder]) : at(plan, state.holder);
    }

    void draw(const Plan& plan, const Schedule& schedule, std::size_t p, const PassWork& work,
              std::size_t noise, const std::vector<Picture>& expected) {
        ASSERT_FALSE(work.idle);
        for (const Settlement& s : schedule.before(p)) {
            settle(plan, s);
        }
        std::size_t input = fold(p, fold(work.key, noise));
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::read || b.access == Access::previous)) {
                EXPECT_EQ(sample(plan, schedule, *b.content), expected[*b.content]) << "read of pass " << p;
                input = fold(input, sample(plan, schedule, *b.content));
            } else if (b.content && b.access == Access::modify) {
                const std::size_t base = *plan.contents[*b.content].modifies;
                const bool empty = schedule.contents()[base].empty;
                const Picture below = empty ? cleared(plan.contents[base]) : at(plan, *b.content);
                EXPECT_EQ(below, expected[base]) << "modify of pass " << p;
                input = fold(input, below);
            }
        }
        for (const PlanBinding& b : plan.passes[p].bindings) {
            if (b.content && (b.access == Access::write || b.access == Access::modify) &&
                schedule.contents()[*b.content].is_drawn(*b.content)) {
                const PlanContent& content = plan.contents[*b.content];
                const bool continues = (content.modifies && !schedule.contents()[*content.modifies].empty) ||
                                       (content.passthrough && work.update);
                const Picture below = continues          ? at(plan, *b.content)
                                      : content.modifies ? cleared(plan.contents[*content.modifies])
                                                         : cleared(content);
                at(plan, *b.content) = drawn_over(below, work, fold(input, *b.content));
            }
        }
    }

    std::vector<Picture> textures_;
    Picture host_{};
};

}  // namespace viscera::test
