#pragma once

#include <utility>

#include "engine/core/graph.h"

/// Short words for graphs in tests. A port is called as its target; `previous("x")` is port "x.last".
namespace viscera::test {

inline TargetDesc target(std::string name, PixelFormat format = PixelFormat::rgba16f, SizeRule size = {}) {
    return {std::move(name), format, size, {}};
}

inline GraphPort read(const std::string& name) {
    return {name, name, Access::read, false, ""};
}
inline GraphPort read_if_any(const std::string& name) {
    return {name, name, Access::read, true, ""};
}
inline GraphPort modify(const std::string& name) {
    return {name, name, Access::modify, false, ""};
}
inline GraphPort previous(const std::string& name) {
    return {name + ".last", name, Access::previous, false, ""};
}
inline GraphPort write(const std::string& name, std::string passthrough = "") {
    return {name + ".new", name, Access::write, false, std::move(passthrough)};
}

inline GraphPass pass(std::string name, std::vector<GraphPort> ports) {
    return {std::move(name), "effect", true, std::move(ports)};
}

}  // namespace viscera::test
