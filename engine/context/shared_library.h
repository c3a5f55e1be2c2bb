#pragma once

#include <initializer_list>
#include <optional>
#include <string>

namespace viscera {

/// A library opened at run time, so that viscera links to none of EGL, OSMesa and GLFW. It stays in memory
/// until the process ends: drivers leave threads and thread-local destructors behind that must not lose their
/// code.
class SharedLibrary {
  public:
    /// Opens the first of `names` that can be opened; its symbols stay out of the global scope. Throws
    /// Error(context) naming `where`, what dlopen said of each, and `remedy` ("install the Debian package
    /// libosmesa6").
    static SharedLibrary open(const char* where, std::initializer_list<const char*> names,
                              const std::string& remedy);

    /// A library that something in the process has loaded already; none otherwise. Loads nothing.
    static std::optional<SharedLibrary> find_loaded(std::initializer_list<const char*> names);

    /// A function by name; null when the library has none of that name.
    template <class Function>
    [[nodiscard]] Function find(const char* name) const {
        return reinterpret_cast<Function>(find_address(name));
    }

    /// A function that must be there. Throws Error(context) naming `where`.
    template <class Function>
    void require(const char* where, const char* name, Function& function) const {
        function = reinterpret_cast<Function>(require_address(where, name));
    }

    [[nodiscard]] const std::string& name() const { return name_; }

  private:
    SharedLibrary(void* handle, std::string name) : handle_(handle), name_(std::move(name)) {}
    [[nodiscard]] void* find_address(const char* name) const;
    [[nodiscard]] void* require_address(const char* where, const char* name) const;

    void* handle_;
    std::string name_;
};

}  // namespace viscera
