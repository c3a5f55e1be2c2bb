#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace viscera::io {

/// A value inside a JSON file together with its place, so that whatever is wrong with it can be named. Views
/// the document and the path, which must outlive it.
class JsonCursor {
  public:
    JsonCursor(const nlohmann::json& value, const std::filesystem::path& file, std::string pointer = "")
        : value_(&value), file_(&file), pointer_(std::move(pointer)) {}

    [[nodiscard]] const nlohmann::json& value() const { return *value_; }
    [[nodiscard]] const std::filesystem::path& file() const { return *file_; }
    [[nodiscard]] const std::string& pointer() const { return pointer_; }

    /// Throws Error(file): "FILE: POINTER: message".
    [[noreturn]] void fail(const std::string& message) const;

    // Each throws Error(file) where the value is of another kind.
    [[nodiscard]] std::optional<JsonCursor> find(std::string_view key) const;  ///< none: no such key, or null
    [[nodiscard]] JsonCursor at(std::string_view key) const;  ///< of an object; must be there
    [[nodiscard]] std::size_t size() const;                   ///< of a list
    [[nodiscard]] JsonCursor at(std::size_t index) const;     ///< of a list; index < size()
    [[nodiscard]] double number() const;
    [[nodiscard]] double number(double least, double most) const;  ///< in a range, ends included
    [[nodiscard]] bool boolean() const;                            ///< true and false, or 1 and 0
    [[nodiscard]] std::string text() const;

  private:
    const nlohmann::json* value_;
    const std::filesystem::path* file_;
    std::string pointer_;
};

}  // namespace viscera::io
