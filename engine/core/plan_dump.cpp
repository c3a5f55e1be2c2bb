#include "engine/core/plan_dump.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace viscera {
namespace {

using Row = std::vector<std::string>;

/// Columns padded to their widest cell, two spaces between them, no spaces at the end of a line.
std::string align(const std::vector<Row>& rows) {
    std::vector<std::size_t> widths;
    for (const Row& row : rows) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t i = 0; i < row.size(); ++i) {
            widths[i] = std::max(widths[i], row[i].size());
        }
    }
    std::string text;
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            text += row[i];
            text.append(i + 1 < row.size() ? widths[i] - row[i].size() + 2 : 0, ' ');
        }
        text += '\n';
    }
    return text;
}

/// Targets that a pass samples or makes, comma-separated: "base, last (previous)", "depth (modify)".
std::string targets_of(const Plan& plan, const PlanPass& pass, bool made) {
    std::string text;
    for (const PlanBinding& binding : pass.bindings) {
        if (!binding.content || makes_content(binding.access) != made) {
            continue;
        }
        text += (text.empty() ? "" : ", ") + plan.contents[*binding.content].target;
        if (binding.access == Access::previous || binding.access == Access::modify) {
            text += " (" + std::string(to_string(binding.access)) + ")";
        }
    }
    return text.empty() ? "-" : text;
}

std::string name_of(const PlanContent& content) {
    const bool from_last_frame = !content.writer && !content.imported;
    return content.target + (from_last_frame ? " (previous)" : "");
}

std::string place_of(const PlanContent& content) {
    if (content.imported) {
        return "imported " + std::to_string(*content.imported);
    }
    return content.texture ? "texture " + std::to_string(*content.texture) : "none";
}

std::string lifetime_of(const Plan& plan, const PlanContent& content) {
    const bool to_the_end = content.last_pass == plan.passes.size();
    return std::to_string(content.first_pass) + " to " +
           (to_the_end ? "end" : std::to_string(content.last_pass));
}

std::string mebibytes(double bytes) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2f MiB", bytes / (1024.0 * 1024.0));
    return text.data();
}

std::string across_and_up(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

double picture_bytes(PixelFormat format, int width, int height) {
    return static_cast<double>(bytes_per_pixel(format)) * width * height;
}

std::string memory_line(const Plan& plan) {
    double shared = 0.0;
    for (const PlanTexture& texture : plan.textures) {
        shared += picture_bytes(texture.format, texture.width, texture.height);
    }
    double apart = 0.0;
    std::size_t count = 0;
    for (const PlanContent& content : plan.contents) {
        if (content.texture && !content.modifies) {
            apart += picture_bytes(content.format, content.width, content.height);
            ++count;
        }
    }
    return "memory: " + mebibytes(shared) + " in " + std::to_string(plan.textures.size()) +
           " textures; without sharing " + mebibytes(apart) + " in " + std::to_string(count) + "\n";
}

/// A string of the dot language.
std::string dot_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += c == '\n' ? ' ' : c;
    }
    return out + "\"";
}

std::string pass_node(const PlanPass& pass, std::size_t index) {
    std::string text = "  p" + std::to_string(index) + " [shape=box, label=" +
                       dot_string(pass.name + " (" + pass.effect + "): " + pass.reason);
    if (!pass.live) {
        text += ", style=filled, fillcolor=grey85, color=grey50, fontcolor=grey40";
    }
    return text + "];\n";
}

std::string content_node(const PlanContent& content, std::size_t index, bool output) {
    const std::string label = name_of(content) + ": " + std::string(info(content.format).name) + " " +
                              across_and_up(content.width, content.height) + ", " + place_of(content);
    return "  c" + std::to_string(index) + " [shape=ellipse, label=" + dot_string(label) +
           (output ? ", penwidth=3" : "") + "];\n";
}

std::string edge(char from_kind, std::size_t from, char to_kind, std::size_t to, const char* attributes) {
    return std::string("  ") + from_kind + std::to_string(from) + " -> " + to_kind + std::to_string(to) +
           attributes + ";\n";
}

std::string edges_of(const Plan& plan, std::size_t pass) {
    std::string text;
    for (const PlanBinding& binding : plan.passes[pass].bindings) {
        if (!binding.content) {
            continue;
        }
        const std::size_t content = *binding.content;
        if (!makes_content(binding.access)) {
            text += edge('c', content, 'p', pass,
                         binding.access == Access::previous ? " [style=dashed, label=\"previous\"]" : "");
            continue;
        }
        if (const auto base = plan.contents[content].modifies) {
            text += edge('c', *base, 'p', pass, " [label=\"modify\"]");
        }
        text += edge('p', pass, 'c', content, "");
    }
    return text;
}

}  // namespace

std::string to_table(const Plan& plan) {
    std::vector<Row> passes{{"#", "pass", "effect", "live", "why", "reads", "writes"}};
    std::size_t live = 0;
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        const PlanPass& pass = plan.passes[p];
        live += pass.live ? 1 : 0;
        passes.push_back({std::to_string(p), pass.name, pass.effect, pass.live ? "yes" : "no", pass.reason,
                          targets_of(plan, pass, false), targets_of(plan, pass, true)});
    }
    std::vector<Row> contents{{"target", "format", "size", "passes", "place"}};
    for (const PlanContent& content : plan.contents) {
        contents.push_back({name_of(content), std::string(info(content.format).name),
                            across_and_up(content.width, content.height), lifetime_of(plan, content),
                            place_of(content)});
    }
    return "frame " + across_and_up(plan.width, plan.height) + ", " + std::to_string(live) + " of " +
           std::to_string(plan.passes.size()) + " passes live\n\n" + align(passes) + "\n" + align(contents) +
           "\n" + memory_line(plan);
}

std::string to_dot(const Plan& plan) {
    std::string text = "digraph plan {\n  rankdir=LR;\n";
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        text += pass_node(plan.passes[p], p);
    }
    for (std::size_t c = 0; c < plan.contents.size(); ++c) {
        const bool output = std::ranges::find(plan.outputs, c, &PlanOutput::content) != plan.outputs.end();
        text += content_node(plan.contents[c], c, output);
    }
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        text += edges_of(plan, p);
    }
    for (const PlanHistory& history : plan.history) {
        if (history.current) {
            text += edge('c', *history.current, 'c', history.previous,
                         " [style=dashed, constraint=false, label=\"next frame\"]");
        }
    }
    return text + "}\n";
}

}  // namespace viscera
