#include "engine/runtime/assets.h"

#include "engine/core/hash.h"
#include "engine/io/png.h"

namespace viscera {

std::shared_ptr<const Image> Assets::image(const std::filesystem::path& file) {
    return shared<Image>(Hash().add(std::string_view(file.native())).value(),
                         [&file] { return std::make_shared<Image>(io::read_image(file)); });
}

Progress Assets::progress(std::string what) const {
    if (!progress_) {
        return {};
    }
    return [this, what = std::move(what)](double fraction) { return progress_(what, fraction); };
}

}  // namespace viscera
