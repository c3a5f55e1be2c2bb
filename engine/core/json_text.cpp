#include "engine/core/json_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include <nlohmann/json.hpp>

namespace viscera {
namespace {

using nlohmann::json;

constexpr std::size_t longest_message = 300;
constexpr std::size_t longest_quote = 80;

/// Length of the UTF-8 character at the start of `text`, 0 where there is none (Unicode 15, table 3-7).
[[nodiscard]] std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
    };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
    const unsigned first = byte(0);
    if (first < 0x80) {
        return 1;
    }
    if (first >= 0xC2 && first <= 0xDF) {
        return follows(1) ? 2 : 0;
    }
    if (first >= 0xE0 && first <= 0xEF) {
        const bool second = first == 0xE0   ? byte(1) >= 0xA0 && byte(1) <= 0xBF
                            : first == 0xED ? byte(1) >= 0x80 && byte(1) <= 0x9F
                                            : follows(1);
        return second && follows(2) ? 3 : 0;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        const bool second = first == 0xF0   ? byte(1) >= 0x90 && byte(1) <= 0xBF
                            : first == 0xF4 ? byte(1) >= 0x80 && byte(1) <= 0x8F
                                            : follows(1);
        return second && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

/// "line 3, column 7" of a byte, both from 1, columns in characters.
[[nodiscard]] std::string place_of(std::string_view text, std::size_t offset) {
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const auto line = std::ranges::count(before, '\n') + 1;
    const std::size_t start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    const auto column =
        std::ranges::count_if(before.substr(start),
                              [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }) +
        1;
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

[[nodiscard]] std::optional<std::size_t> find_bad_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8_length(text.substr(at));
        if (length == 0) {
            return at;
        }
        at += length;
    }
    return std::nullopt;
}

/// Builds the value while watching depth, number of values and repeated keys, which nlohmann's own reader
/// lets pass.
class Builder final : public nlohmann::json_sax<json> {
  public:
    Builder(std::string_view text, const JsonLimits& limits, std::vector<JsonFault>& faults)
        : text_(text), limits_(limits), faults_(faults) {}

    [[nodiscard]] json take() { return std::move(root_); }

    bool null() override { return add(nullptr) != nullptr; }
    bool boolean(bool value) override { return add(value) != nullptr; }
    bool number_integer(number_integer_t value) override { return add(value) != nullptr; }
    bool number_unsigned(number_unsigned_t value) override { return add(value) != nullptr; }
    bool number_float(number_float_t value, const string_t&) override { return add(value) != nullptr; }
    bool string(string_t& value) override { return add(std::move(value)) != nullptr; }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(json::object()); }
    bool start_array(std::size_t) override { return open(json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        if (open_.back()->contains(name)) {
            faults_.push_back({child_pointer(pointer(), name), "the key stands twice"});
        }
        keys_.back() = name;
        return true;
    }

    bool parse_error(std::size_t position, const std::string&, const json::exception& error) override {
        // The library's text begins with its own name and, for syntax, with line and column.
        std::string_view what = error.what();
        for (const std::string_view lead : {"] ", ": "}) {
            if (lead == "] " || what.starts_with("parse error at line")) {
                const std::size_t end = what.find(lead);
                what.remove_prefix(end == std::string_view::npos ? 0 : end + lead.size());
            }
        }
        std::string message(what.substr(0, longest_message));
        // The excerpt may end within a character.
        std::ranges::replace_if(
            message, [](char c) { return static_cast<unsigned char>(c) >= 0x80 || c < ' '; }, '?');
        faults_.push_back({"", place_of(text_, position == 0 ? 0 : position - 1) + ": " + message});
        return false;
    }

  private:
    [[nodiscard]] json* add(json value) {
        if (++count_ > limits_.values) {
            faults_.push_back({"", "more than " + std::to_string(limits_.values) + " values"});
            return nullptr;
        }
        if (open_.empty()) {
            root_ = std::move(value);
            return &root_;
        }
        json& parent = *open_.back();
        if (parent.is_array()) {
            parent.push_back(std::move(value));
            return &parent.back();
        }
        return &(parent[keys_.back()] = std::move(value));
    }

    [[nodiscard]] bool open(json value) {
        if (open_.size() >= limits_.depth) {
            faults_.push_back({"", "nested deeper than " + std::to_string(limits_.depth) + " levels"});
            return false;
        }
        json* const added = add(std::move(value));
        if (added == nullptr) {
            return false;
        }
        open_.push_back(added);
        keys_.emplace_back();
        return true;
    }

    [[nodiscard]] bool close() {
        open_.pop_back();
        keys_.pop_back();
        return true;
    }

    [[nodiscard]] std::string pointer() const {
        std::string text;
        for (std::size_t i = 0; i + 1 < open_.size(); ++i) {
            text = open_[i]->is_array() ? child_pointer(text, open_[i]->size() - 1)
                                        : child_pointer(text, keys_[i]);
        }
        return text;
    }

    std::string_view text_;
    const JsonLimits& limits_;
    std::vector<JsonFault>& faults_;
    json root_;
    // An element stays where it is while it is open: nothing is added to its parents meanwhile.
    std::vector<json*> open_;
    std::vector<std::string> keys_;
    std::size_t count_ = 0;
};

}  // namespace

std::string child_pointer(std::string_view pointer, std::string_view key) {
    std::string text(pointer);
    text += '/';
    for (const char c : key) {
        if (c == '~') {
            text += "~0";
        } else if (c == '/') {
            text += "~1";
        } else {
            text += c;
        }
    }
    return text;
}

std::string child_pointer(std::string_view pointer, std::size_t index) {
    return std::string(pointer) + "/" + std::to_string(index);
}

std::optional<std::vector<std::string>> pointer_tokens(std::string_view pointer) {
    std::vector<std::string> tokens;
    if (!pointer.empty() && pointer.front() != '/') {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < pointer.size(); ++i) {
        if (pointer[i] == '/') {
            tokens.emplace_back();
        } else if (pointer[i] != '~') {
            tokens.back() += pointer[i];
        } else if (i + 1 < pointer.size() && (pointer[i + 1] == '0' || pointer[i + 1] == '1')) {
            tokens.back() += pointer[++i] == '0' ? '~' : '/';
        } else {
            return std::nullopt;
        }
    }
    return tokens;
}

std::string_view kind_name(const json& value) {
    switch (value.type()) {
        case json::value_t::object:
            return "an object";
        case json::value_t::array:
            return "a list";
        case json::value_t::string:
            return "a string";
        case json::value_t::boolean:
            return value.get<bool>() ? "true" : "false";
        case json::value_t::number_integer:
        case json::value_t::number_unsigned:
        case json::value_t::number_float:
            return "a number";
        default:
            return "null";
    }
}

std::string shorten(std::string_view text, std::size_t longest) {
    if (text.size() <= longest) {
        return std::string(text);
    }
    while (longest > 0 && (static_cast<unsigned char>(text[longest]) & 0xC0U) == 0x80U) {
        --longest;
    }
    return std::string(text.substr(0, longest)) + "...";
}

std::string quote(std::string_view text) {
    return json(shorten(text, longest_quote)).dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string number_text(double value) {
    std::array<char, 32> buffer{};
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return {buffer.data(), result.ptr};
}

json parse_json(std::string_view text, std::vector<JsonFault>& faults, const JsonLimits& limits) {
    if (text.starts_with("\xEF\xBB\xBF")) {
        text.remove_prefix(3);
    }
    if (const std::optional<std::size_t> bad = find_bad_utf8(text)) {
        faults.push_back({"", place_of(text, *bad) + ": not valid UTF-8"});
        return nullptr;
    }
    Builder builder(text, limits, faults);
    return json::sax_parse(text, &builder) ? builder.take() : json(nullptr);
}

}  // namespace viscera
