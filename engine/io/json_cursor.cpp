#include "engine/io/json_cursor.h"

#include "engine/core/error.h"
#include "engine/core/json_text.h"

namespace viscera::io {

void JsonCursor::fail(const std::string& message) const {
    throw Error(ErrorCode::file, file_->string(), pointer_.empty() ? message : pointer_ + ": " + message);
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
    if (!value_->is_object()) {
        fail("must be an object, is " + std::string(kind_name(*value_)));
    }
    const auto found = value_->find(key);
    if (found == value_->end() || found->is_null()) {
        return std::nullopt;
    }
    return JsonCursor(*found, *file_, child_pointer(pointer_, key));
}

JsonCursor JsonCursor::at(std::string_view key) const {
    std::optional<JsonCursor> found = find(key);
    if (!found) {
        fail("has no \"" + std::string(key) + "\"");
    }
    return *std::move(found);
}

std::size_t JsonCursor::size() const {
    if (!value_->is_array()) {
        fail("must be a list, is " + std::string(kind_name(*value_)));
    }
    return value_->size();
}

JsonCursor JsonCursor::at(std::size_t index) const {
    return {(*value_)[index], *file_, child_pointer(pointer_, index)};
}

double JsonCursor::number() const {
    if (!value_->is_number()) {
        fail("must be a number, is " + std::string(kind_name(*value_)));
    }
    return value_->get<double>();
}

double JsonCursor::number(double least, double most) const {
    const double n = number();
    if (!(n >= least && n <= most)) {
        fail("must be from " + number_text(least) + " to " + number_text(most) + ", is " + number_text(n));
    }
    return n;
}

bool JsonCursor::boolean() const {
    if (value_->is_boolean()) {
        return value_->get<bool>();
    }
    if (*value_ == 0 || *value_ == 1) {
        return *value_ == 1;
    }
    fail("must be true or false, is " + std::string(kind_name(*value_)));
}

std::string JsonCursor::text() const {
    if (!value_->is_string()) {
        fail("must be a string, is " + std::string(kind_name(*value_)));
    }
    return value_->get<std::string>();
}

}  // namespace viscera::io
