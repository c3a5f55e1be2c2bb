#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/core/params_json.h"
#include "engine/core/params_tree.h"

namespace viscera {
namespace {

using nlohmann::json;

/// Whole numbers as such, so that a range reads "0" and not "0.0".
[[nodiscard]] json bound(double value) {
    constexpr double exact = 9007199254740992.0;  // 2^53
    return value == std::trunc(value) && std::abs(value) < exact ? json(static_cast<std::int64_t>(value))
                                                                 : json(value);
}

[[nodiscard]] json number_schema(const FieldInfo& info, std::string_view type) {
    json schema{{"type", type}};
    if (std::isfinite(info.min)) {
        schema[info.min_excluded ? "exclusiveMinimum" : "minimum"] = bound(info.min);
    }
    if (std::isfinite(info.max)) {
        schema["maximum"] = bound(info.max);
    }
    return schema;
}

[[nodiscard]] json object_schema(const std::vector<FieldNode>& fields);

/// What a field may hold, without its description.
[[nodiscard]] json value_schema(const FieldNode& node) {
    switch (node.kind) {
        case FieldKind::boolean:
            return {{"type", "boolean"}};
        case FieldKind::integer:
            return number_schema(node.info, "integer");
        case FieldKind::number:
            return number_schema(node.info, "number");
        case FieldKind::vector:
            return {{"type", "array"},
                    {"items", number_schema(node.info, "number")},
                    {"minItems", node.components},
                    {"maxItems", node.components}};
        case FieldKind::text:
            return {{"type", "string"}};
        case FieldKind::path:
            return node.info.required ? json{{"type", "string"}, {"minLength", 1}} : json{{"type", "string"}};
        case FieldKind::choice:
            return {{"enum", node.choices}};
        case FieldKind::group:
            return object_schema(node.children);
        case FieldKind::list:
            return {{"type", "array"}, {"items", value_schema(node.children.front())}};
        case FieldKind::optional:
            return {{"anyOf", {value_schema(node.children.front()), {{"type", "null"}}}}};
    }
    return json::object();
}

[[nodiscard]] std::string description(const FieldInfo& info) {
    std::string text(info.doc);
    if (!info.unit.empty()) {
        text += (text.empty() ? "[" : " [") + std::string(info.unit) + "]";
    }
    return text;
}

[[nodiscard]] json object_schema(const std::vector<FieldNode>& fields) {
    json properties = json::object();
    json required = json::array();
    properties["comment"] = {{"description", "A note for people; not read."}};
    for (const FieldNode& node : fields) {
        json schema = value_schema(node);
        if (const std::string text = description(node.info); !text.empty()) {
            schema["description"] = text;
        }
        if (node.info.required) {
            required.push_back(node.info.name);
        } else if (node.kind != FieldKind::group) {
            schema["default"] = node.value;
        }
        properties[std::string(node.info.name)] = std::move(schema);
    }
    json schema{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
    if (!required.empty()) {
        schema["required"] = std::move(required);
    }
    return schema;
}

}  // namespace

json params_schema(const VisitFunction& visit) {
    return object_schema(params_tree(visit));
}

}  // namespace viscera
