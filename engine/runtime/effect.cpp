#include "engine/runtime/effect.h"

#include <algorithm>

#include "engine/core/error.h"

namespace viscera {

void Registry::add(std::string name, std::string doc, Factory make) {
    if (find(name) != nullptr) {
        throw Error(ErrorCode::usage, name, "an effect of this name is registered already");
    }
    entries_.push_back({std::move(name), std::move(doc), std::move(make)});
}

const Registry::Entry* Registry::find(std::string_view name) const {
    const auto found = std::ranges::find(entries_, name, &Entry::name);
    return found == entries_.end() ? nullptr : &*found;
}

}  // namespace viscera
