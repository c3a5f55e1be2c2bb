#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace viscera {

enum class LogLevel { debug, info, warning, error };

/// Receives every message of the library; may be called from the EXR writer's thread.
using LogCallback = std::function<void(LogLevel, std::string_view)>;

/// Passes messages to the host's callback and counts survivable faults, each reported once.
/// Thread-safe. The library itself writes to no stream.
class Log {
  public:
    Log() = default;
    explicit Log(LogCallback callback) : callback_(std::move(callback)) {}
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;

    void write(LogLevel level, std::string_view message);
    void debug(std::string_view message) { write(LogLevel::debug, message); }
    void info(std::string_view message) { write(LogLevel::info, message); }
    void warning(std::string_view message) { write(LogLevel::warning, message); }
    void error(std::string_view message) { write(LogLevel::error, message); }

    /// Counts a survivable fault under `key` by `count` and passes `message` on the first time only.
    void fault(std::string_view key, std::string_view message, std::uint64_t count = 1);

    /// Faults counted so far, by key.
    [[nodiscard]] std::map<std::string, std::uint64_t, std::less<>> faults() const;

  private:
    mutable std::mutex mutex_;
    LogCallback callback_;
    std::map<std::string, std::uint64_t, std::less<>> faults_;
};

}  // namespace viscera
