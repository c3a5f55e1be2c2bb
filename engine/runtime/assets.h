#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <typeindex>
#include <utility>

#include "engine/core/image.h"
#include "engine/core/log.h"

namespace viscera {

/// What passes share beyond one frame: files read, things computed from them, and their copies on the GPU.
/// Each is made when it is first asked for and never before, so a file that no live pass needs is not opened.
/// Whatever holds OpenGL objects dies with the renderer, while its context is current.
class Assets {
  public:
    explicit Assets(Log& log) : log_(log) {}

    /// The object of type T known by `key` (a hash of everything it is made from); made by `make` on first
    /// use.
    template <class T, class Make>
    std::shared_ptr<T> shared(std::uint64_t key, Make&& make) {
        const Id id{std::type_index(typeid(T)), key};
        if (const auto found = entries_.find(id); found != entries_.end()) {
            return std::static_pointer_cast<T>(found->second);
        }
        std::shared_ptr<T> made = std::forward<Make>(make)();
        entries_.emplace(id, made);
        return made;
    }

    /// A picture file (PNG, JPEG, EXR). Throws Error(file).
    [[nodiscard]] std::shared_ptr<const Image> image(const std::filesystem::path& file);

    /// Number of objects made so far.
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] Log& log() { return log_; }

  private:
    using Id = std::pair<std::type_index, std::uint64_t>;
    Log& log_;
    std::map<Id, std::shared_ptr<void>> entries_;
};

}  // namespace viscera
