#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/core/params_json.h"

namespace viscera {

/// As read_params, for an object that also holds keys which the caller reads itself: `others` are neither
/// read nor at fault, and take part in 'did you mean'.
void read_params_beside(const nlohmann::json& object, std::string_view pointer,
                        const std::filesystem::path& base, const VisitFunction& visit,
                        std::span<const std::string_view> others, std::vector<JsonFault>& faults);

/// The range as words, for a value that is outside: "must be at least 0 mm".
[[nodiscard]] std::string range_words(const FieldInfo& info);

}  // namespace viscera
