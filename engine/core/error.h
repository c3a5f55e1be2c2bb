#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace viscera {

/// What kind of bad input or bad machine an Error reports. The value is the app's exit code.
enum class ErrorCode : int {
    usage = 2,    ///< a command line or an argument that a caller got wrong
    scene = 3,    ///< a scene, a parameter or a graph that does not hold
    file = 4,     ///< a file that is missing, damaged, or cannot be written
    context = 5,  ///< no OpenGL context of the kind asked for
    gl = 6,       ///< OpenGL or a shader failed
    limit = 7,    ///< the device or the memory is too small for what was asked
};

/// Word for an error code, as it stands in reports: "usage", "scene", "file", "context", "gl", "limit".
[[nodiscard]] std::string_view to_string(ErrorCode code);

/// The one exception of viscera. `where` names the file, JSON pointer, pass or parameter at fault;
/// what() is "where: message".
class Error : public std::runtime_error {
  public:
    Error(ErrorCode code, std::string where, const std::string& message);

    [[nodiscard]] ErrorCode code() const noexcept { return code_; }
    [[nodiscard]] const std::string& where() const noexcept { return where_; }
    /// what() without the place.
    [[nodiscard]] std::string_view message() const noexcept;

  private:
    ErrorCode code_;
    std::string where_;
};

}  // namespace viscera
