#include "engine/core/plan_resolve.h"

#include <algorithm>
#include <set>
#include <vector>

#include "engine/core/plan_shapes.h"

namespace viscera {
namespace {

class Resolver {
  public:
    Resolver(const Graph& graph, int width, int height, int max_size);
    CompileResult run();

  private:
    void bind_pass(std::size_t pass);
    void check_ports();
    void check_pair(const GraphPort& first, const GraphPort& second);
    std::optional<std::size_t> bind_read(const GraphPort& port);
    std::optional<std::size_t> bind_previous(const GraphPort& port);
    std::optional<std::size_t> make_content(const GraphPort& port);
    void bind_passthrough(const GraphPort& port, PlanContent& content);
    void check_not_stand_in(const GraphPort& port, std::size_t content);
    void bind_outputs();
    PlanContent blank_content(std::string_view target) const;
    std::size_t add_content(PlanContent content);
    std::string why_unwritten(std::string_view target) const;
    void fault(const GraphPort& port, std::string message);

    const Graph& graph_;
    CompileResult result_;
    Plan& plan_;
    TargetShapes shapes_;
    std::map<std::string_view, std::size_t> current_;       ///< the content that each name means now
    std::map<std::string_view, std::string_view> written_;  ///< first enabled pass that writes each name
    std::map<std::string_view, std::string_view> disabled_writers_;
    std::set<std::string_view> pass_names_;
    std::size_t pass_ = 0;  ///< the one being bound
};

Resolver::Resolver(const Graph& graph, int width, int height, int max_size)
    : graph_(graph),
      plan_(result_.plan),
      shapes_(resolve_shapes(graph, width, height, max_size, result_.faults)) {
    plan_.width = width;
    plan_.height = height;
    for (const GraphPass& pass : graph.passes) {
        for (const GraphPort& port : pass.ports) {
            if (port.access == Access::write) {
                (pass.enabled ? written_ : disabled_writers_).try_emplace(port.target, pass.name);
            }
        }
    }
}

CompileResult Resolver::run() {
    for (const ImportedTarget& imported : graph_.imported) {
        if (!current_.contains(imported.name)) {
            current_[imported.name] = add_content(blank_content(imported.name));
        }
    }
    plan_.passes.resize(graph_.passes.size());
    for (pass_ = 0; pass_ < graph_.passes.size(); ++pass_) {
        bind_pass(pass_);
    }
    for (PlanHistory& history : plan_.history) {
        if (const auto found = current_.find(history.target); found != current_.end()) {
            history.current = found->second;
        }
    }
    bind_outputs();
    return std::move(result_);
}

void Resolver::bind_pass(std::size_t index) {
    const GraphPass& pass = graph_.passes[index];
    PlanPass& planned = plan_.passes[index];
    planned.name = pass.name;
    planned.effect = pass.effect;
    for (const GraphPort& port : pass.ports) {
        planned.bindings.push_back({port.port, port.access, std::nullopt});
    }
    if (!pass.enabled) {
        planned.reason = "disabled";
        return;
    }
    check_ports();
    // All reads first: a pass that reads and writes one name reads what stood there before it.
    for (std::size_t i = 0; i < pass.ports.size(); ++i) {
        const GraphPort& port = pass.ports[i];
        if (port.access == Access::read) {
            planned.bindings[i].content = bind_read(port);
        } else if (port.access == Access::previous) {
            planned.bindings[i].content = bind_previous(port);
        }
    }
    std::set<std::string_view> made;
    for (std::size_t i = 0; i < pass.ports.size(); ++i) {
        const GraphPort& port = pass.ports[i];
        if (makes_content(port.access) && made.insert(port.target).second) {
            planned.bindings[i].content = make_content(port);
        }
    }
}

void Resolver::check_ports() {
    const GraphPass& pass = graph_.passes[pass_];
    if (!pass_names_.insert(pass.name).second) {
        result_.faults.push_back({pass.name, "", "", "another pass above has this name"});
    }
    for (std::size_t i = 0; i < pass.ports.size(); ++i) {
        const GraphPort& port = pass.ports[i];
        // A described name was checked where it is described.
        if (!is_target_name(port.target) && !shapes_.contains(port.target)) {
            fault(port, "is not a valid target name");
        }
        if (!port.passthrough.empty() && port.access != Access::write) {
            fault(port, "only a write can have a passthrough");
        }
        for (std::size_t j = 0; j < i; ++j) {
            check_pair(pass.ports[j], port);
        }
    }
}

void Resolver::check_pair(const GraphPort& first, const GraphPort& second) {
    if (first.port == second.port) {
        fault(second, "the pass has two ports of this name");
    }
    if (first.target != second.target) {
        return;
    }
    const auto either = [&](Access access) { return first.access == access || second.access == access; };
    if (makes_content(first.access) && makes_content(second.access)) {
        fault(second, "is written twice in one pass");
    } else if (either(Access::read) && either(Access::modify)) {
        fault(second, "is read and modified in one pass");
    } else if (either(Access::read) && either(Access::write)) {
        const auto shape = shapes_.find(second.target);
        if (shape != shapes_.end() && shape->second.imported) {
            fault(second, "an imported target cannot be read and written in one pass");
        }
    }
}

std::optional<std::size_t> Resolver::bind_read(const GraphPort& port) {
    if (const auto found = current_.find(port.target); found != current_.end()) {
        return found->second;
    }
    if (!port.optional) {
        fault(port, why_unwritten(port.target));
    }
    return std::nullopt;
}

std::optional<std::size_t> Resolver::bind_previous(const GraphPort& port) {
    if (const auto shape = shapes_.find(port.target); shape != shapes_.end() && shape->second.imported) {
        fault(port, "an imported target has no last frame");
        return std::nullopt;
    }
    if (!written_.contains(port.target)) {
        if (!port.optional) {
            fault(port, why_unwritten(port.target));
        }
        return std::nullopt;
    }
    const auto known = std::ranges::find(plan_.history, port.target, &PlanHistory::target);
    if (known != plan_.history.end()) {
        return known->previous;
    }
    const std::size_t content = add_content(blank_content(port.target));
    plan_.history.push_back({port.target, content, std::nullopt});
    return content;
}

std::optional<std::size_t> Resolver::make_content(const GraphPort& port) {
    const auto above = current_.find(port.target);
    PlanContent content = blank_content(port.target);
    content.writer = pass_;
    if (port.access == Access::modify) {
        if (above == current_.end()) {
            if (!port.optional) {
                fault(port, why_unwritten(port.target));
            }
            return std::nullopt;
        }
        content.modifies = above->second;
    }
    const auto shape = shapes_.find(port.target);
    if (shape == shapes_.end()) {
        fault(port, "the target is written but not described");
    } else if (!shape->second.writable) {
        fault(port, "the imported target is not writable");
    }
    // A write into the host's texture destroys what it held, as a modify does.
    if (above != current_.end() && (content.modifies || content.imported)) {
        check_not_stand_in(port, above->second);
    }
    if (port.access == Access::write && !port.passthrough.empty()) {
        bind_passthrough(port, content);
    }
    const std::size_t index = add_content(std::move(content));
    current_[port.target] = index;
    return index;
}

void Resolver::bind_passthrough(const GraphPort& port, PlanContent& content) {
    const auto& ports = graph_.passes[pass_].ports;
    const auto source = std::ranges::find(ports, port.passthrough, &GraphPort::port);
    if (source == ports.end() || makes_content(source->access)) {
        fault(port, "passthrough '" + port.passthrough + "' is not a port that this pass reads");
        return;
    }
    const auto& bindings = plan_.passes[pass_].bindings;
    content.passthrough = bindings[static_cast<std::size_t>(source - ports.begin())].content;
    if (!content.passthrough) {
        return;
    }
    const PlanContent& from = plan_.contents[*content.passthrough];
    if (from.format != content.format || from.width != content.width || from.height != content.height) {
        fault(port, "passthrough '" + port.passthrough + "' differs from the target in format or size");
    }
}

void Resolver::check_not_stand_in(const GraphPort& port, std::size_t content) {
    const PlanContent& base = plan_.contents[content];
    if (base.passthrough) {
        fault(port, "what is written over may be a passthrough of '" +
                        plan_.contents[*base.passthrough].target + "'");
    }
    const auto result = std::ranges::find(plan_.contents, std::optional(content), &PlanContent::passthrough);
    if (result != plan_.contents.end()) {
        fault(port, "what is written over may stand in for '" + result->target + "' by passthrough");
    }
}

void Resolver::bind_outputs() {
    std::set<std::string_view> seen;
    for (const std::string& output : graph_.outputs) {
        if (!seen.insert(output).second) {
            result_.faults.push_back({"", "", output, "is listed twice as output"});
        } else if (!written_.contains(output) &&
                   !(current_.contains(output) && plan_.contents[current_.at(output)].writer.has_value())) {
            result_.faults.push_back({"", "", output, "output: " + why_unwritten(output)});
        } else if (const auto found = current_.find(output); found != current_.end()) {
            plan_.outputs.push_back({output, found->second});
        }
    }
}

PlanContent Resolver::blank_content(std::string_view target) const {
    PlanContent content;
    content.target = target;
    if (const auto found = shapes_.find(target); found != shapes_.end()) {
        const TargetShape& shape = found->second;
        content.format = shape.format;
        content.width = shape.width;
        content.height = shape.height;
        content.clear = shape.clear;
        content.imported = shape.imported;
    }
    return content;
}

std::size_t Resolver::add_content(PlanContent content) {
    plan_.contents.push_back(std::move(content));
    return plan_.contents.size() - 1;
}

std::string Resolver::why_unwritten(std::string_view target) const {
    if (const auto below = written_.find(target); below != written_.end()) {
        return "no pass above writes it; the first to do so is '" + std::string(below->second) + "'";
    }
    if (const auto disabled = disabled_writers_.find(target); disabled != disabled_writers_.end()) {
        return "is written only by disabled pass '" + std::string(disabled->second) + "'";
    }
    return "no pass writes it";
}

void Resolver::fault(const GraphPort& port, std::string message) {
    result_.faults.push_back({graph_.passes[pass_].name, port.port, port.target, std::move(message)});
}

}  // namespace

CompileResult resolve_names(const Graph& graph, int width, int height, int max_size) {
    return Resolver(graph, width, height, max_size).run();
}

}  // namespace viscera
