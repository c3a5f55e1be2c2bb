#pragma once

#include <memory>

#include "engine/context/context.h"

namespace viscera {

// One maker for each backend; create_context() chooses among them. Each makes its context current and throws
// Error(context) that says why not.

[[nodiscard]] std::unique_ptr<Context> create_egl_device(const ContextOptions& options);
[[nodiscard]] std::unique_ptr<Context> create_egl_surfaceless(const ContextOptions& options);
[[nodiscard]] std::unique_ptr<Context> create_osmesa(const ContextOptions& options);

/// EGL devices of this machine. Throws Error(context) when they cannot be listed.
[[nodiscard]] int count_egl_devices();

/// Throws Error(context) when `options` want hardware and `info` tells of software.
void check_hardware(const ContextInfo& info, const ContextOptions& options);

}  // namespace viscera
