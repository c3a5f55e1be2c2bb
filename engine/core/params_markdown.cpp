#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/core/json_text.h"
#include "engine/core/params_json.h"
#include "engine/core/params_tree.h"

namespace viscera {
namespace {

/// Text within a table's cell.
[[nodiscard]] std::string cell(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        if (c == '|') {
            safe += "\\|";
        } else {
            safe += c == '\n' || c == '\r' ? ' ' : c;
        }
    }
    return safe;
}

[[nodiscard]] std::string type_of(const FieldNode& node) {
    switch (node.kind) {
        case FieldKind::boolean:
            return "true or false";
        case FieldKind::integer:
            return "whole number";
        case FieldKind::number:
            return "number";
        case FieldKind::vector:
            return std::to_string(node.components) + " numbers";
        case FieldKind::text:
            return "text";
        case FieldKind::path:
            return "file";
        case FieldKind::choice:
            return "choice";
        case FieldKind::group:
            return "object";
        case FieldKind::list:
            return "list of " + type_of(node.children.front());
        case FieldKind::optional:
            return type_of(node.children.front()) + " or null";
    }
    return {};
}

/// A number as people write it: 10, not 10.0.
[[nodiscard]] std::string value_text(const nlohmann::json& value) {
    if (value.is_number()) {
        return number_text(value.get<double>());
    }
    if (!value.is_array()) {
        return value.dump();
    }
    std::string text = "[";
    for (const nlohmann::json& item : value) {
        text += (text.size() > 1 ? ", " : "") + value_text(item);
    }
    return text + "]";
}

[[nodiscard]] std::string default_of(const FieldNode& node) {
    if (node.info.required) {
        return "required";
    }
    return node.kind == FieldKind::group ? "" : "`" + value_text(node.value) + "`";
}

/// The node whose range and choices stand for the field: what a list or an optional holds.
[[nodiscard]] const FieldNode& innermost(const FieldNode& node) {
    const bool holds = node.kind == FieldKind::list || node.kind == FieldKind::optional;
    return holds ? innermost(node.children.front()) : node;
}

[[nodiscard]] std::string range_of(const FieldNode& field) {
    const FieldNode& node = innermost(field);
    std::string text;
    for (const std::string& word : node.choices) {
        text += (text.empty() ? "`" : ", `") + word + "`";
    }
    if (!text.empty()) {
        return text;
    }
    if (std::isfinite(node.info.min)) {
        text = (node.info.min_excluded ? "> " : "≥ ") + number_text(node.info.min);
    }
    if (std::isfinite(node.info.max)) {
        text += (text.empty() ? "≤ " : ", ≤ ") + number_text(node.info.max);
    }
    return text;
}

void append_rows(const std::vector<FieldNode>& fields, const std::string& prefix, std::string& table) {
    for (const FieldNode& node : fields) {
        std::string key = prefix + std::string(node.info.name);
        table += "| `" + cell(key) + "` | " + type_of(node) + " | " + cell(default_of(node)) + " | " +
                 cell(range_of(node)) + " | " + cell(node.info.unit) + " | " + cell(node.info.doc) + " |\n";
        const FieldNode* inner = &node;
        for (; inner->kind == FieldKind::list || inner->kind == FieldKind::optional;
             inner = &inner->children.front()) {
            key += inner->kind == FieldKind::list ? "[]" : "";
        }
        append_rows(inner->children, key + ".", table);
    }
}

}  // namespace

std::string params_markdown(const VisitFunction& visit) {
    std::string table = "| key | type | default | range | unit | meaning |\n|---|---|---|---|---|---|\n";
    append_rows(params_tree(visit), "", table);
    return table;
}

}  // namespace viscera
