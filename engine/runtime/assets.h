#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>

#include "engine/core/image.h"
#include "engine/core/log.h"
#include "engine/core/progress.h"
#include "engine/io/disk_cache.h"

namespace viscera {

/// What passes share beyond one frame: files read, things computed from them, and their copies on the GPU.
/// Each is made when it is first asked for and never before, so a file that no live pass needs is not opened.
/// Whatever holds OpenGL objects dies with the renderer, while its context is current.
class Assets {
  public:
    /// cache_folder: of disk_cache(); empty for none.
    explicit Assets(Log& log, ProgressCallback progress = {}, std::filesystem::path cache_folder = {})
        : log_(log), progress_(std::move(progress)), disk_cache_(std::move(cache_folder), log) {}

    /// The object of type T known by `key` (a hash of everything it is made from); made by `make` on first
    /// use.
    template <class T, class Make>
    std::shared_ptr<T> shared(std::uint64_t key, Make&& make) {
        const Id id{std::type_index(typeid(T)), key};
        if (const auto found = entries_.find(id); found != entries_.end()) {
            found->second.used = scenes_;
            return std::static_pointer_cast<T>(found->second.object);
        }
        std::shared_ptr<T> made = std::forward<Make>(make)();
        entries_.emplace(id, Entry{made, scenes_});
        return made;
    }

    /// A scene, or a changed one, has come: what nobody holds and none of the last few asked for is given up,
    /// so that a parameter that changes all the time does not fill the memory. Whatever is needed again is
    /// made again.
    void begin_scene() {
        ++scenes_;
        std::erase_if(entries_, [this](const auto& entry) {
            return entry.second.object.use_count() == 1 && entry.second.used + kept_scenes < scenes_;
        });
    }

    /// For keys of what is made from a file: where it lies, how large it is and when it was written. Of a
    /// folder its files count, too. Each is looked at when it is first asked for, and not again before
    /// forget_files(), so this may be called in each frame. What a file names beside itself does not count.
    [[nodiscard]] std::uint64_t file_key(const std::filesystem::path& file);
    /// Whether files have been written since is asked anew: a file that was is then read again, and what was
    /// made from it made again.
    void forget_files() { file_keys_.clear(); }

    /// A picture file (PNG, JPEG, EXR). Throws Error(file).
    [[nodiscard]] std::shared_ptr<const Image> image(const std::filesystem::path& file);

    /// Number of objects held.
    [[nodiscard]] std::size_t size() const { return entries_.size(); }
    [[nodiscard]] Log& log() { return log_; }
    /// Keeps what is long in the making beyond the process.
    [[nodiscard]] const io::DiskCache& disk_cache() const { return disk_cache_; }
    /// For long work, so that whoever waits is told of it as `what` and may cancel it. Empty when nobody
    /// asked to be told.
    [[nodiscard]] Progress progress(std::string what) const;

  private:
    static constexpr std::uint64_t kept_scenes = 8;
    using Id = std::pair<std::type_index, std::uint64_t>;
    struct Entry {
        std::shared_ptr<void> object;
        std::uint64_t used = 0;  ///< number of the scene that last asked for it
    };
    Log& log_;
    ProgressCallback progress_;
    io::DiskCache disk_cache_;
    std::map<Id, Entry> entries_;
    std::map<std::string, std::uint64_t, std::less<>> file_keys_;  ///< by path
    std::uint64_t scenes_ = 0;
};

}  // namespace viscera
