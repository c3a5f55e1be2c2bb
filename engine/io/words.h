#pragma once

#include <optional>
#include <string_view>

namespace viscera::io {

/// Takes the next word off the front of `text`, white space before it included; empty at the end.
[[nodiscard]] std::string_view take_word(std::string_view& text);

/// Takes the next line off the front of `text`, without its line end; the rest where there is none.
[[nodiscard]] std::string_view take_line(std::string_view& text);

/// The number that a word is, nan and inf among them; none where it is no number as a whole. Numbers too
/// large or too small for double become 0: no coordinate is one.
[[nodiscard]] std::optional<double> to_number(std::string_view word);

}  // namespace viscera::io
