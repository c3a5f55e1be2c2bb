#include "engine/core/error.h"

namespace viscera {

std::string_view to_string(ErrorCode code) {
    switch (code) {
        case ErrorCode::usage:
            return "usage";
        case ErrorCode::scene:
            return "scene";
        case ErrorCode::file:
            return "file";
        case ErrorCode::context:
            return "context";
        case ErrorCode::gl:
            return "gl";
        case ErrorCode::limit:
            return "limit";
    }
    return "unknown";
}

Error::Error(ErrorCode code, std::string where, const std::string& message)
    : std::runtime_error(where.empty() ? message : where + ": " + message),
      code_(code),
      where_(std::move(where)) {}

std::string_view Error::message() const noexcept {
    const std::string_view whole = what();
    return where_.empty() ? whole : whole.substr(where_.size() + 2);
}

}  // namespace viscera
