#include "engine/core/plan.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/plan_resolve.h"
#include "engine/core/plan_textures.h"

namespace viscera {
namespace {

/// Marks live passes and the contents that must exist, backwards from the outputs.
class Culler {
  public:
    explicit Culler(Plan& plan) : plan_(plan), needed_(plan.contents.size(), false) {}

    std::vector<bool> run() {
        for (const PlanOutput& output : plan_.outputs) {
            need(output.content);
        }
        while (!waiting_.empty()) {
            const std::size_t pass = waiting_.back();
            waiting_.pop_back();
            need_inputs(pass);
        }
        return std::move(needed_);
    }

  private:
    void need(std::size_t index) {
        if (needed_[index]) {
            return;
        }
        needed_[index] = true;
        if (const auto writer = plan_.contents[index].writer) {
            if (!plan_.passes[*writer].live) {
                plan_.passes[*writer].live = true;
                waiting_.push_back(*writer);
            }
            return;
        }
        for (const PlanHistory& history : plan_.history) {
            if (history.previous == index && history.current) {
                need(*history.current);
            }
        }
    }

    void need_inputs(std::size_t pass) {
        for (const PlanBinding& binding : plan_.passes[pass].bindings) {
            if (!binding.content) {
                continue;
            }
            const PlanContent& content = plan_.contents[*binding.content];
            if (content.modifies && binding.access == Access::modify) {
                need(*content.modifies);
            }
            // The depth that a pass writes, and what it modifies, serve its own depth test even when nobody
            // reads the result.
            if (binding.access != Access::write || info(content.format).is_depth) {
                need(*binding.content);
            }
        }
    }

    Plan& plan_;
    std::vector<bool> needed_;
    std::vector<std::size_t> waiting_;
};

/// What a pass draws into at once is one framebuffer. Optional writes that nobody needs are not drawn.
void check_sizes(const Graph& graph, const std::vector<bool>& needed, CompileResult& result) {
    const Plan& plan = result.plan;
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        const PlanContent* first = nullptr;
        for (std::size_t b = 0; b < plan.passes[p].bindings.size(); ++b) {
            const PlanBinding& binding = plan.passes[p].bindings[b];
            const GraphPort& port = graph.passes[p].ports[b];
            if (!binding.content || !makes_content(binding.access) ||
                (port.optional && !needed[*binding.content])) {
                continue;
            }
            const PlanContent& content = plan.contents[*binding.content];
            first = first == nullptr ? &content : first;
            if (content.width != first->width || content.height != first->height) {
                result.faults.push_back(
                    {plan.passes[p].name, port.port, port.target,
                     "differs in size from '" + first->target + "', which the pass draws into as well"});
            }
        }
    }
}

std::optional<std::string> use_by_output(const Plan& plan, std::size_t pass) {
    for (const PlanOutput& output : plan.outputs) {
        if (plan.contents[output.content].writer == pass) {
            return "writes output '" + output.target + "'";
        }
    }
    return std::nullopt;
}

std::optional<std::string> use_by_pass(const Plan& plan, std::size_t pass) {
    for (std::size_t user = pass + 1; user < plan.passes.size(); ++user) {
        if (!plan.passes[user].live) {
            continue;
        }
        for (const PlanBinding& binding : plan.passes[user].bindings) {
            if (!binding.content) {
                continue;
            }
            const PlanContent& content = plan.contents[*binding.content];
            if (binding.access == Access::read && content.writer == pass) {
                return "read by '" + plan.passes[user].name + "'";
            }
            if (binding.access == Access::modify && plan.contents[*content.modifies].writer == pass) {
                return "modified by '" + plan.passes[user].name + "'";
            }
        }
    }
    return std::nullopt;
}

std::string use_by_next_frame(const Plan& plan, std::size_t pass) {
    for (const PlanHistory& history : plan.history) {
        if (!history.current || plan.contents[*history.current].writer != pass) {
            continue;
        }
        for (const PlanPass& user : plan.passes) {
            for (const PlanBinding& binding : user.bindings) {
                if (user.live && binding.access == Access::previous && binding.content == history.previous) {
                    return "read by '" + user.name + "' in the next frame";
                }
            }
        }
    }
    return {};
}

void give_reasons(Plan& plan) {
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        PlanPass& pass = plan.passes[p];
        if (!pass.reason.empty()) {
            continue;
        }
        if (!pass.live) {
            pass.reason = "culled: no output needs it";
        } else if (auto output = use_by_output(plan, p)) {
            pass.reason = *std::move(output);
        } else if (auto user = use_by_pass(plan, p)) {
            pass.reason = *std::move(user);
        } else {
            pass.reason = use_by_next_frame(plan, p);
        }
    }
}

void drop_unneeded(Plan& plan, const std::vector<bool>& needed) {
    std::erase_if(plan.history, [&](const PlanHistory& history) { return !needed[history.previous]; });
    for (PlanPass& pass : plan.passes) {
        for (PlanBinding& binding : pass.bindings) {
            if (pass.live && binding.content && !needed[*binding.content]) {
                binding.content.reset();
            }
        }
    }
}

}  // namespace

std::string to_string(const Fault& fault) {
    std::string text;
    const auto add = [&](std::string_view word, const std::string& name) {
        if (!name.empty()) {
            text += (text.empty() ? "" : ", ");
            text += std::string(word) + " '" + name + "'";
        }
    };
    add("pass", fault.pass);
    add("port", fault.port);
    add("target", fault.target);
    return text.empty() ? fault.message : text + ": " + fault.message;
}

CompileResult compile(const Graph& graph, int width, int height, int max_size) {
    CompileResult result = resolve_names(graph, width, height, max_size);
    const std::vector<bool> needed = Culler(result.plan).run();
    check_sizes(graph, needed, result);
    if (result.faults.empty()) {
        drop_unneeded(result.plan, needed);
        give_reasons(result.plan);
        assign_textures(result.plan, needed);
    }
    return result;
}

Plan compile_or_throw(const Graph& graph, int width, int height, int max_size) {
    CompileResult result = compile(graph, width, height, max_size);
    if (result.faults.empty()) {
        return std::move(result.plan);
    }
    std::string text;
    for (const Fault& fault : result.faults) {
        text += (text.empty() ? "" : "\n") + to_string(fault);
    }
    const bool limit = std::ranges::all_of(result.faults, &Fault::limit);
    throw Error(limit ? ErrorCode::limit : ErrorCode::scene, "graph", text);
}

}  // namespace viscera
