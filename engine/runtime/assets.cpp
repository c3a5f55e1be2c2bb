#include "engine/runtime/assets.h"

#include <system_error>

#include "engine/core/hash.h"
#include "engine/io/png.h"

namespace viscera {
namespace {

/// Of a file that is not there, too: whoever reads it says so.
std::uint64_t state_of(const std::filesystem::path& file) {
    std::error_code ignored;
    return Hash()
        .add(std::string_view(file.native()))
        .add(std::filesystem::last_write_time(file, ignored).time_since_epoch().count())
        .add(std::filesystem::file_size(file, ignored))
        .value();
}

}  // namespace

std::uint64_t Assets::file_key(const std::filesystem::path& file) {
    const std::string_view name = file.native();
    if (const auto found = file_keys_.find(name); found != file_keys_.end()) {
        return found->second;
    }
    std::uint64_t sum = state_of(file);
    std::error_code error;
    // Folders list their files in any order.
    for (std::filesystem::directory_iterator at(file, error), end; !error && at != end; at.increment(error)) {
        sum += state_of(at->path());
    }
    const std::uint64_t key = Hash().add(sum).value();
    file_keys_.emplace(name, key);
    return key;
}

std::shared_ptr<const Image> Assets::image(const std::filesystem::path& file) {
    return shared<Image>(file_key(file), [&file] { return std::make_shared<Image>(io::read_image(file)); });
}

Progress Assets::progress(std::string what) const {
    if (!progress_) {
        return {};
    }
    return [this, what = std::move(what)](double fraction) { return progress_(what, fraction); };
}

}  // namespace viscera
