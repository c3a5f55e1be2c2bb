#include "engine/core/log.h"

namespace viscera {

void Log::write(LogLevel level, std::string_view message) {
    const std::scoped_lock lock(mutex_);
    if (callback_) {
        callback_(level, message);
    }
}

void Log::fault(std::string_view key, std::string_view message, std::uint64_t count) {
    {
        const std::scoped_lock lock(mutex_);
        const auto found = faults_.find(key);
        if (found != faults_.end()) {
            found->second += count;
            return;
        }
        faults_.emplace(key, count);
    }
    write(LogLevel::warning, message);
}

std::map<std::string, std::uint64_t, std::less<>> Log::faults() const {
    const std::scoped_lock lock(mutex_);
    return faults_;
}

}  // namespace viscera
