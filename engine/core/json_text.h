#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/core/params_json.h"

namespace viscera {

/// RFC 6901: the pointer of a member or an element of what `pointer` names.
[[nodiscard]] std::string child_pointer(std::string_view pointer, std::string_view key);
[[nodiscard]] std::string child_pointer(std::string_view pointer, std::size_t index);
/// The keys that a pointer passes through, unescaped. Empty optional where it is not RFC 6901.
[[nodiscard]] std::optional<std::vector<std::string>> pointer_tokens(std::string_view pointer);

/// "an object", "a list", "a string", "a number", "true", "false", "null"
[[nodiscard]] std::string_view kind_name(const nlohmann::json& value);
/// At most `longest` bytes of a UTF-8 text and "...", cut between characters.
[[nodiscard]] std::string shorten(std::string_view text, std::size_t longest);
/// In double quotes, control characters escaped, cut where it is long.
[[nodiscard]] std::string quote(std::string_view text);
/// Shortest decimal that reads back as the same double.
[[nodiscard]] std::string number_text(double value);

/// Most that parse_json takes, so that a hostile file costs neither stack nor memory without end.
struct JsonLimits {
    std::size_t depth = 64;
    std::size_t values = 2'000'000;
};

/// JSON text (UTF-8, byte order mark allowed) as a value. Syntax errors (with line and column), invalid
/// UTF-8, keys that stand twice in an object and passed limits are appended to `faults`; after a fault that
/// stops the reading the value is null.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, std::vector<JsonFault>& faults,
                                        const JsonLimits& limits = {});

}  // namespace viscera
