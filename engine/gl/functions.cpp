#include "engine/gl/functions.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.h"
#include "engine/gl/glad/core_names.h"

namespace viscera::gl {

namespace {

constexpr auto where = "OpenGL functions";

struct Loading {
    ProcAddress proc;
    std::vector<std::string_view> missing;  ///< functions of core 3.3 that the loader does not know
};

GLADapiproc find_function(void* user, const char* name) {
    auto& loading = *static_cast<Loading*>(user);
    const auto function = reinterpret_cast<GLADapiproc>(loading.proc(name));
    if (function == nullptr && std::ranges::binary_search(core_names, std::string_view(name))) {
        loading.missing.emplace_back(name);
    }
    return function;
}

std::string list_names(const std::vector<std::string_view>& names) {
    constexpr std::size_t shown = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), shown); ++i) {
        text.append(i == 0 ? "" : ", ").append(names[i]);
    }
    return names.size() > shown ? text + " and " + std::to_string(names.size() - shown) + " more" : text;
}

}  // namespace

std::unique_ptr<const Functions> Functions::load(ProcAddress proc) {
    if (proc == nullptr) {
        throw Error(ErrorCode::context, where, "no function was given to find OpenGL functions with");
    }
    auto functions = std::make_unique<Functions>();
    Loading loading{proc, {}};
    const int version = viscera_load_functions(functions.get(), find_function, &loading);
    if (functions->GetString == nullptr) {
        throw Error(ErrorCode::context, where, "glGetString is missing: the loader finds no OpenGL");
    }
    const auto* text = reinterpret_cast<const char*>(functions->GetString(GL_VERSION));
    if (text == nullptr) {
        throw Error(ErrorCode::context, where, "no OpenGL context is current on this thread");
    }
    // The version string decides, not the pointers: loaders return stubs for functions that do not exist.
    if (std::string_view(text).starts_with("OpenGL ES") || functions->VERSION_3_3 == 0) {
        throw Error(ErrorCode::context, where,
                    "OpenGL 3.3 core is needed, the context is '" + std::string(text) + "'");
    }
    if (!loading.missing.empty()) {
        throw Error(ErrorCode::context, where,
                    "the context says '" + std::string(text) + "' but lacks " + list_names(loading.missing));
    }
    if (version == 0) {
        throw Error(ErrorCode::context, where, "the context's extensions cannot be listed");
    }
    return functions;
}

}  // namespace viscera::gl
