#include "engine/context/shared_library.h"

#include <dlfcn.h>

#include "engine/core/error.h"

namespace viscera {

SharedLibrary SharedLibrary::open(const char* where, std::initializer_list<const char*> names,
                                  const std::string& remedy) {
    std::string said;
    for (const char* name : names) {
        if (void* handle = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE)) {
            return {handle, name};
        }
        const char* reason = dlerror();
        said.append(said.empty() ? "" : "; ").append(reason != nullptr ? reason : name);
    }
    throw Error(ErrorCode::context, where, "library not found (" + said + "): " + remedy);
}

std::optional<SharedLibrary> SharedLibrary::find_loaded(std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (void* handle = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD)) {
            dlclose(handle);  // whoever loaded it keeps it; the handle is the same for all
            return SharedLibrary(handle, name);
        }
    }
    return std::nullopt;
}

void* SharedLibrary::find_address(const char* name) const {
    return dlsym(handle_, name);
}

void* SharedLibrary::require_address(const char* where, const char* name) const {
    if (void* address = find_address(name)) {
        return address;
    }
    throw Error(ErrorCode::context, where, name_ + " lacks the function " + name);
}

}  // namespace viscera
