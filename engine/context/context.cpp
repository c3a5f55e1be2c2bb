#include "engine/context/context.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/context/backends.h"
#include "engine/context/context_info.h"
#include "engine/context/current_slot.h"
#include "engine/context/window.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

constexpr std::array<std::pair<Backend, std::string_view>, 5> names{
    {{Backend::egl_device, "egl-device"},
     {Backend::egl_surfaceless, "egl-surfaceless"},
     {Backend::osmesa, "osmesa"},
     {Backend::glfw, "glfw"},
     {Backend::current, "current"}}};

std::unique_ptr<Context> create(Backend backend, const ContextOptions& options) {
    switch (backend) {
        case Backend::egl_device:
            return create_egl_device(options);
        case Backend::egl_surfaceless:
            return create_egl_surfaceless(options);
        case Backend::osmesa:
            return create_osmesa(options);
        case Backend::glfw:
            return create_window(options);
        case Backend::current:
            break;
    }
    throw Error(ErrorCode::context, std::string(to_string(backend)),
                "the caller's context is not created but wrapped, by wrap_current_context()");
}

BackendReport probe(Backend backend, const ContextOptions& options) {
    BackendReport report;
    report.backend = backend;
    try {
        report.info = create_context(backend, options)->info();
        report.why = report.info->remark;
    } catch (const Error& error) {
        report.why = error.what();
    }
    return report;
}

}  // namespace

std::string_view to_string(Backend backend) {
    return std::ranges::find(names, backend, &std::pair<Backend, std::string_view>::first)->second;
}

std::vector<Backend> parse_backends(std::string_view word) {
    if (word == "auto") {
        return {Backend::egl_device, Backend::egl_surfaceless, Backend::osmesa};
    }
    if (word == "egl") {
        return {Backend::egl_device, Backend::egl_surfaceless};
    }
    const auto* found = std::ranges::find(names, word, &std::pair<Backend, std::string_view>::second);
    if (found == names.end()) {
        throw Error(
            ErrorCode::usage, "backend",
            "'" + std::string(word) + "' is none of auto, egl, egl-device, egl-surfaceless, osmesa, glfw");
    }
    return {found->first};
}

void check_hardware(const ContextInfo& info, const ContextOptions& options) {
    if (options.require_hardware && info.software) {
        const std::string remark = nvidia_remark();
        throw Error(ErrorCode::context, std::string(to_string(info.backend)),
                    "hardware is required, but '" + info.renderer + "' renders on the CPU" +
                        (remark.empty() ? "" : "; " + remark));
    }
}

std::unique_ptr<Context> create_context(Backend backend, const ContextOptions& options) {
    KeepCurrent keep;  // what was current stays so when this fails
    auto context = create(backend, options);
    keep.dismiss();
    return context;
}

std::unique_ptr<Context> create_first_context(std::span<const Backend> backends,
                                              const ContextOptions& options, std::vector<Refusal>& refusals) {
    for (const Backend backend : backends) {
        try {
            return create_context(backend, options);
        } catch (const Error& error) {
            refusals.push_back({backend, error.what()});
        }
    }
    std::string said;
    for (const Refusal& refusal : refusals) {
        said += "\n  " + refusal.why;
    }
    throw Error(ErrorCode::context, "context", "no backend gives an OpenGL 3.3 context:" + said);
}

std::vector<BackendReport> probe_backends() {
    const KeepCurrent keep;
    std::vector<BackendReport> reports;
    ContextOptions options;
    options.visible = false;
    int devices = 0;
    try {
        devices = count_egl_devices();
    } catch (const Error&) {
        // The probe without an index, below, is refused with the same reason.
    }
    for (int i = 0; i < devices; ++i) {
        options.egl_device = i;
        reports.push_back(probe(Backend::egl_device, options));
    }
    options.egl_device.reset();
    if (devices == 0) {
        reports.push_back(probe(Backend::egl_device, options));
    }
    for (const Backend backend : {Backend::egl_surfaceless, Backend::osmesa, Backend::glfw}) {
        reports.push_back(probe(backend, options));
    }
    return reports;
}

}  // namespace viscera
