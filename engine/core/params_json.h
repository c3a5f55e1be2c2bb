#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/core/params.h"

namespace viscera {

/// One thing wrong with a JSON document.
struct JsonFault {
    std::string pointer;  ///< RFC 6901: "/passes/2/parameters/radius_mm"
    std::string message;
};

/// Anything that visits its own fields: `[&](ParamVisitor& v) { params.visit(v); }`.
using VisitFunction = std::function<void(ParamVisitor&)>;

/// Fills a struct from a JSON object. Unknown keys (with 'did you mean'), wrong types, values out of range
/// and missing required keys are appended to `faults`, each with its pointer; fields at fault keep their
/// value. `base`: folder against which relative AssetPaths are resolved.
void read_params(const nlohmann::json& object, std::string_view pointer, const std::filesystem::path& base,
                 const VisitFunction& visit, std::vector<JsonFault>& faults);

/// The struct as a JSON object; reading it back gives an equal struct.
[[nodiscard]] nlohmann::json write_params(const VisitFunction& visit);

/// JSON Schema (draft 2020-12) of the struct: types, ranges, defaults, descriptions with units; no additional
/// properties.
[[nodiscard]] nlohmann::json params_schema(const VisitFunction& visit);

/// Option table in Markdown: | key | type | default | range | unit | meaning |, nested keys dotted.
[[nodiscard]] std::string params_markdown(const VisitFunction& visit);

/// The candidate nearest to `word` in edit distance, when it is near enough to be meant; else empty.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            const std::vector<std::string>& candidates);

}  // namespace viscera
