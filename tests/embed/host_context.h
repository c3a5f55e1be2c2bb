#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "engine/context/context.h"

namespace viscera::test {

/// An OpenGL context as a host makes one, with no help of viscera's: from EGL without a surface, or OSMesa.
class HostContext {
  public:
    enum class Kind { egl, egl_debug, osmesa };

    /// Makes it and makes it current. Throws std::runtime_error.
    explicit HostContext(Kind kind);
    HostContext(const HostContext&) = delete;
    HostContext& operator=(const HostContext&) = delete;
    ~HostContext();

    void make_current();
    /// Nothing is current on this thread afterwards.
    void release();
    [[nodiscard]] ProcAddress proc() const;

    class Library;

  private:
    std::unique_ptr<Library> library_;
};

[[nodiscard]] inline std::string kind_name(const testing::TestParamInfo<HostContext::Kind>& info) {
    switch (info.param) {
        case HostContext::Kind::egl:
            return "egl";
        case HostContext::Kind::egl_debug:
            return "egl_debug";
        case HostContext::Kind::osmesa:
            return "osmesa";
    }
    return "unknown";
}

[[nodiscard]] inline auto each_host() {
    return testing::Values(HostContext::Kind::egl, HostContext::Kind::egl_debug, HostContext::Kind::osmesa);
}

}  // namespace viscera::test
