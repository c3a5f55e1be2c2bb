#include "engine/runtime/frame.h"

namespace viscera {

void HostValues::set(std::string_view name, std::span<const float> values) {
    auto found = entries_.find(name);
    if (found == entries_.end()) {
        found = entries_.emplace(std::string(name), Entry{}).first;
    }
    found->second.values.assign(values.begin(), values.end());
    found->second.version = next_version_++;
}

void HostValues::erase(std::string_view name) {
    const auto found = entries_.find(name);
    if (found != entries_.end()) {
        entries_.erase(found);
    }
}

const HostValues::Entry* HostValues::find(std::string_view name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() ? nullptr : &found->second;
}

}  // namespace viscera
