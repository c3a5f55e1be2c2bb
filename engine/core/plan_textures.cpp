#include "engine/core/plan_textures.h"

#include <algorithm>
#include <array>

namespace viscera {
namespace {

void find_lifetimes(Plan& plan, const std::vector<bool>& needed) {
    for (PlanContent& content : plan.contents) {
        content.first_pass = content.last_pass = content.writer.value_or(0);
    }
    const auto lives_until = [&](std::size_t content, std::size_t pass) {
        plan.contents[content].last_pass = std::max(plan.contents[content].last_pass, pass);
    };
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        for (const PlanBinding& binding : plan.passes[p].bindings) {
            if (plan.passes[p].live && binding.content && binding.access == Access::read) {
                lives_until(*binding.content, p);
            }
        }
    }
    for (const PlanOutput& output : plan.outputs) {
        lives_until(output.content, plan.passes.size());
    }
    for (const PlanHistory& history : plan.history) {
        lives_until(history.previous, plan.passes.size());
        if (history.current) {
            lives_until(*history.current, plan.passes.size());
        }
    }
    // Backwards, since what stands in for a content may itself be one that has a stand-in.
    for (std::size_t c = plan.contents.size(); c-- > 0;) {
        const PlanContent& content = plan.contents[c];
        if (!needed[c]) {
            continue;
        }
        if (content.passthrough) {
            lives_until(*content.passthrough, content.last_pass);
        }
        if (content.modifies) {
            lives_until(*content.modifies, content.first_pass);
        }
    }
}

/// A content with all that modify it, one after another in one texture.
struct Chain {
    bool needed = false;
    bool exclusive = false;  ///< outlives the frame: its texture is nobody else's
    std::size_t last_pass = 0;
};

}  // namespace

void assign_textures(Plan& plan, const std::vector<bool>& needed) {
    find_lifetimes(plan, needed);

    std::vector<std::size_t> root(plan.contents.size());
    std::vector<Chain> chains(plan.contents.size());  // at the index of the first content
    for (std::size_t c = 0; c < plan.contents.size(); ++c) {
        const PlanContent& content = plan.contents[c];
        root[c] = content.modifies ? root[*content.modifies] : c;
        if (needed[c] && !content.imported) {
            Chain& chain = chains[root[c]];
            chain.needed = true;
            chain.last_pass = std::max(chain.last_pass, content.last_pass);
        }
    }
    for (const PlanHistory& history : plan.history) {
        chains[root[history.previous]].exclusive = true;
        if (history.current) {
            chains[root[*history.current]].exclusive = true;
        }
    }

    // First fit in the order of the first pass, which for intervals needs the fewest textures. Contents with
    // different clear values do not share: what little of a texture was drawn is then all that the next one
    // has to clear.
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c < plan.contents.size(); ++c) {
        if (root[c] == c && chains[c].needed) {
            order.push_back(c);
        }
    }
    std::ranges::stable_sort(order, {}, [&](std::size_t c) { return plan.contents[c].first_pass; });
    std::vector<std::optional<std::size_t>> busy_until;  // of each texture; none: never free again
    std::vector<std::array<float, 4>> cleared_to;        // each texture
    for (const std::size_t c : order) {
        const PlanContent& content = plan.contents[c];
        const Chain& chain = chains[c];
        std::size_t texture = 0;
        for (; texture < plan.textures.size(); ++texture) {
            const PlanTexture& candidate = plan.textures[texture];
            if (!chain.exclusive && busy_until[texture] && *busy_until[texture] < content.first_pass &&
                candidate.format == content.format && candidate.width == content.width &&
                candidate.height == content.height && cleared_to[texture] == content.clear) {
                break;
            }
        }
        if (texture == plan.textures.size()) {
            plan.textures.push_back({content.format, content.width, content.height});
            busy_until.emplace_back();
            cleared_to.push_back(content.clear);
        }
        busy_until[texture] = chain.exclusive ? std::nullopt : std::optional(chain.last_pass);
        plan.contents[c].texture = texture;
    }
    for (std::size_t c = 0; c < plan.contents.size(); ++c) {
        if (needed[c] && !plan.contents[c].imported) {
            plan.contents[c].texture = plan.contents[root[c]].texture;
        }
    }
}

}  // namespace viscera
