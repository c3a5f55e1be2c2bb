#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace viscera::test {

/// How the app is called, beyond its arguments.
struct Call {
    std::map<std::string, std::optional<std::string>> environment{};  ///< set, or none: unset
    std::optional<unsigned long> most_file_bytes{};                   ///< what a full disk looks like
};

struct Ended {
    int code = -1;    ///< exit code; -1 when a signal ended it
    int signal = 0;   ///< that signal
    std::string out;  ///< stdout
    std::string err;  ///< stderr
};

/// Runs `viscera` to its end, in an empty folder. Without more said it sees no display, no home and no cache.
[[nodiscard]] Ended viscera(const std::vector<std::string>& arguments, const Call& call = {});

/// Runs any program of the PATH, in an empty folder.
[[nodiscard]] Ended run(const std::vector<std::string>& arguments, const Call& call = {});

}  // namespace viscera::test
