#include "engine/core/eye_graph.h"

#include <algorithm>
#include <map>
#include <optional>

#include "engine/core/eyes.h"

namespace viscera {
namespace {

/// Finds which passes depend on the eye, then writes the graph that has them twice.
class EyeExpander {
  public:
    EyeExpander(const Graph& graph, std::span<const char> uses_view) : graph_(graph) {
        for (std::size_t p = 0; p < graph.passes.size(); ++p) {
            doubled_.push_back(graph.passes[p].enabled && uses_view[p] != 0 ? 1 : 0);
        }
        for (const ImportedTarget& imported : graph.imported) {
            imported_.insert(imported.name);
        }
        for (std::size_t p = 0; p < graph.passes.size(); ++p) {
            note_writes(p, at_end_);
        }
    }

    EyeGraph run() {
        while (spread()) {
        }
        result_.graph.imported = graph_.imported;
        Writers last;
        for (std::size_t p = 0; p < graph_.passes.size(); ++p) {
            if (doubled_[p] != 0) {
                add(p, 0, last);
                add(p, 1, last);
            } else {
                add(p, -1, last);
            }
            note_writes(p, last);
        }
        describe_targets();
        for (const auto& [name, writer] : last) {
            if (is_doubled(writer)) {
                result_.eyed.emplace(name);
            }
        }
        for (const std::string& output : graph_.outputs) {
            for (std::string& name : result_.names_of(output)) {
                if (std::ranges::find(result_.graph.outputs, name) == result_.graph.outputs.end()) {
                    result_.graph.outputs.push_back(std::move(name));
                }
            }
        }
        return std::move(result_);
    }

  private:
    /// The last enabled pass above that wrote each name.
    using Writers = std::map<std::string_view, std::size_t>;

    [[nodiscard]] bool is_doubled(std::size_t pass) const { return doubled_[pass] != 0; }
    /// Whether the host brings one content per eye.
    [[nodiscard]] bool imported_per_eye(std::string_view name) const {
        return imported_.contains(eye_name(name, 0)) && imported_.contains(eye_name(name, 1));
    }
    void note_writes(std::size_t pass, Writers& last) const {
        for (const GraphPort& port : graph_.passes[pass].ports) {
            if (graph_.passes[pass].enabled && makes_content(port.access)) {
                last[port.target] = pass;
            }
        }
    }
    /// Whether what a name holds at this place differs from eye to eye.
    [[nodiscard]] bool differs(std::string_view name, const Writers& last) const {
        const auto writer = last.find(name);
        return writer == last.end() ? !imported_.contains(name) && imported_per_eye(name)
                                    : is_doubled(writer->second);
    }

    /// One round over all passes; true when a pass was found that depends on the eye after all.
    bool spread() {
        bool found = false;
        const auto mark = [&](std::size_t pass) {
            found = found || doubled_[pass] == 0;
            doubled_[pass] = 1;
        };
        Writers last;
        for (std::size_t p = 0; p < graph_.passes.size(); ++p) {
            const GraphPass& pass = graph_.passes[p];
            if (!pass.enabled) {
                continue;
            }
            for (const GraphPort& port : pass.ports) {
                const bool sees = port.access == Access::previous ? differs(port.target, at_end_)
                                  : port.access != Access::write  ? differs(port.target, last)
                                                                  : false;
                if (sees) {
                    mark(p);
                }
            }
            for (const GraphPort& port : pass.ports) {
                const auto writer = last.find(port.target);
                if (is_doubled(p) && port.access == Access::modify && writer != last.end()) {
                    mark(writer->second);  // each eye goes on in a texture of its own
                }
            }
            note_writes(p, last);
        }
        return found;
    }

    void add(std::size_t index, int eye, const Writers& last) {
        GraphPass pass = graph_.passes[index];
        if (eye >= 0) {
            pass.name = eye_name(pass.name, eye);
        }
        for (GraphPort& port : pass.ports) {
            const bool per_eye =
                eye >= 0 && (makes_content(port.access)        ? true
                             : port.access == Access::previous ? differs(port.target, at_end_)
                                                               : differs(port.target, last));
            if (!per_eye) {
                continue;
            }
            if (makes_content(port.access) && imported_.contains(port.target) && pass.enabled && eye == 0) {
                fault(pass, port,
                      "both eyes would draw into this imported target; import '" + eye_name(port.target, 0) +
                          "' and '" + eye_name(port.target, 1) + "'");
            }
            port.target = eye_name(port.target, eye);
        }
        result_.graph.passes.push_back(std::move(pass));
        result_.passes.push_back({index, eye});
    }

    void fault(const GraphPass& pass, const GraphPort& port, std::string message) {
        result_.faults.push_back({pass.name, port.port, port.target, std::move(message)});
    }

    /// Each name as often as it is written: shared, per eye, or both one after the other.
    void describe_targets() {
        std::set<std::string_view> written;
        for (const GraphPass& pass : result_.graph.passes) {
            for (const GraphPort& port : pass.ports) {
                if (makes_content(port.access)) {
                    written.insert(port.target);
                }
            }
        }
        std::set<std::string_view> given(imported_.begin(), imported_.end());
        for (const TargetDesc& target : graph_.targets) {
            given.insert(target.name);
        }
        for (const TargetDesc& target : graph_.targets) {
            bool split = false;
            for (int eye = 0; eye < 2; ++eye) {
                const std::string name = eye_name(target.name, eye);
                if (!written.contains(name) || imported_.contains(name)) {
                    continue;
                }
                split = true;
                if (given.contains(name)) {
                    result_.faults.push_back(
                        {"", "", name,
                         "is the name of another target; each eye's '" + target.name + "' needs it"});
                    continue;
                }
                TargetDesc own = target;
                own.name = name;
                result_.graph.targets.push_back(std::move(own));
            }
            if (!split || written.contains(target.name)) {
                result_.graph.targets.push_back(target);
            }
        }
    }

    const Graph& graph_;
    EyeGraph result_;
    std::vector<char> doubled_;  ///< by pass
    std::set<std::string, std::less<>> imported_;
    Writers at_end_;  ///< of the frame: what its next one reads as the previous content
};

}  // namespace

std::vector<std::string> EyeGraph::names_of(std::string_view name) const {
    if (!eyed.contains(name)) {
        return {std::string(name)};
    }
    return {eye_name(name, 0), eye_name(name, 1)};
}

EyeGraph expand_eyes(const Graph& graph, std::span<const char> uses_view) {
    return EyeExpander(graph, uses_view).run();
}

}  // namespace viscera
