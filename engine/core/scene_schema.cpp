#include <string>

#include <nlohmann/json.hpp>

#include "engine/core/json_text.h"
#include "engine/core/scene.h"
#include "engine/core/scene_fields.h"

namespace viscera {
namespace {

using nlohmann::json;

constexpr const char* reference = "#/$defs/reference";
constexpr const char* target_name = "#/$defs/target_name";

[[nodiscard]] json with_references(const json& schema);

/// An object in which any member may be a reference, and which may itself stand beside one.
[[nodiscard]] json object_with_references(json schema) {
    for (json& member : schema["properties"]) {
        member = with_references(member);
    }
    schema["properties"]["$ref"] = {{"$ref", "#/$defs/reference_name"}};
    if (schema.contains("required")) {
        // What the reference names may bring it.
        schema["if"] = {{"not", {{"required", json::array({"$ref"})}}}};
        schema["then"] = {{"required", schema["required"]}};
        schema.erase("required");
    }
    return schema;
}

/// As `schema`, or `{"$ref": "#/shared/NAME"}` in its place.
[[nodiscard]] json with_references(const json& schema) {
    if (schema.contains("properties")) {
        return object_with_references(schema);
    }
    json value = schema;
    json outer = json::object();
    for (const char* key : {"description", "default"}) {
        if (value.contains(key)) {
            outer[key] = value[key];
            value.erase(key);
        }
    }
    if (value.empty()) {
        return schema;
    }
    if (value.contains("items")) {
        value["items"] = with_references(value["items"]);
    }
    if (value.contains("anyOf")) {
        for (json& part : value["anyOf"]) {
            part = part.contains("properties") ? object_with_references(part) : part;
        }
    }
    outer["if"] = {{"type", "object"},
                   {"required", json::array({"$ref"})},
                   {"propertyNames", {{"enum", {"$ref", "comment"}}}}};
    outer["then"] = {{"$ref", reference}};
    outer["else"] = std::move(value);
    return outer;
}

template <class Fields>
[[nodiscard]] json schema_of() {
    Fields fields;
    return params_schema([&fields](ParamVisitor& v) { fields.visit(v); });
}

void set_length(json& schema, int least, int most) {
    schema["minItems"] = least;
    schema["maxItems"] = most;
}

[[nodiscard]] json target_schema() {
    json schema = schema_of<SceneTargetFields>();
    set_length(schema["properties"]["size"]["anyOf"][0], 2, 2);
    set_length(schema["properties"]["clear"]["anyOf"][0], 1, 4);
    const json number{{"type", "number"}};
    schema["not"] = {{"properties", {{"scale", number}, {"size", {{"type", "array"}}}}},
                     {"required", {"scale", "size"}}};
    return schema;
}

[[nodiscard]] json targets_schema() {
    return {{"type", "object"},
            {"description", "What targets are made of, by name; those left out are as their effects ask."},
            {"properties", {{"comment", json::object()}}},
            {"propertyNames", {{"anyOf", {{{"const", "comment"}}, {{"$ref", target_name}}}}}},
            {"additionalProperties", {{"$ref", "#/$defs/target"}}}};
}

/// A pass, with the parameters of its effect where that is one of those known.
[[nodiscard]] json pass_schema(std::span<const EffectSchema> effects) {
    json schema = schema_of<ScenePassFields>();
    json& properties = schema["properties"];
    properties["name"]["pattern"] = "^[A-Za-z0-9_.-]+$";
    properties["name"]["maxLength"] = 128;
    json names = json::array();
    json rules = json::array();
    for (const EffectSchema& effect : effects) {
        names.push_back({{"const", effect.name}, {"description", effect.doc}});
        const std::string definition = "#/$defs/" + child_pointer("", "effect." + effect.name).substr(1);
        json then{{"properties", {{"parameters", {{"$ref", definition}}}}}};
        if (params_schema(effect.visit).contains("required")) {
            then["required"] = json::array({"parameters"});
        }
        rules.push_back({{"if",
                          {{"properties", {{"effect", {{"const", effect.name}}}}},
                           {"required", json::array({"effect"})}}},
                         {"then", std::move(then)}});
    }
    if (!names.empty()) {
        properties["effect"]["oneOf"] = std::move(names);
        schema["allOf"] = std::move(rules);
    }
    properties["parameters"] = {{"type", "object"}, {"description", "Parameters of the effect."}};
    properties["targets"] = {
        {"type", "object"},
        {"description",
         "Targets that stand in for the effect's own, by port; null: an optional port "
         "is left unbound."},
        {"properties", {{"comment", json::object()}}},
        {"additionalProperties", {{"anyOf", {{{"$ref", target_name}}, {{"type", "null"}}}}}}};
    return schema;
}

}  // namespace

json scene_schema(std::span<const EffectSchema> effects) {
    json schema = schema_of<SceneFields>();
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    schema["title"] = "viscera scene";
    json& properties = schema["properties"];
    set_length(properties["resolution"], 2, 2);
    properties["outputs"]["items"] = {{"$ref", target_name}};
    properties["outputs"]["minItems"] = 1;
    properties["outputs"]["uniqueItems"] = true;
    properties["shared"] = {{"type", "object"},
                            {"description", "Parts that parameters name by {\"$ref\": \"#/shared/NAME\"}."}};
    properties["targets"] = targets_schema();
    properties["passes"] = {{"type", "array"},
                            {"description", "Passes in the order they run."},
                            {"items", {{"$ref", "#/$defs/pass"}}}};
    schema["required"].push_back("passes");

    json& definitions = schema["$defs"];
    definitions["target_name"] = {
        {"type", "string"}, {"pattern", R"(^[a-z0-9_]+(\.[a-z0-9_]+)*$)"}, {"maxLength", 128}};
    definitions["reference_name"] = {{"type", "string"}, {"pattern", "^#/shared/"}};
    definitions["reference"] = {
        {"type", "object"},
        {"properties", {{"$ref", {{"$ref", "#/$defs/reference_name"}}}, {"comment", json::object()}}},
        {"required", json::array({"$ref"})},
        {"additionalProperties", false}};
    definitions["target"] = target_schema();
    definitions["pass"] = pass_schema(effects);
    for (const EffectSchema& effect : effects) {
        json& definition = definitions["effect." + effect.name];
        definition = object_with_references(params_schema(effect.visit));
        definition["description"] = effect.doc;
    }
    return schema;
}

}  // namespace viscera
