#include "effects/tissue/saved_energy.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/size_text.h"
#include "engine/io/exr.h"
#include "engine/runtime/assets.h"

namespace viscera::tissue {
namespace {

/// The time that a frame's header gives: in decimal places enough for a double, else as a float.
std::optional<double> time_of(const io::ExrPart& part) {
    std::optional<double> time;
    for (const io::ExrAttribute& attribute : part.attributes) {
        if (const auto* text = std::get_if<std::string>(&attribute.value);
            text != nullptr && attribute.name == "viscera:time") {
            double exact = 0.0;
            const auto result = std::from_chars(text->data(), text->data() + text->size(), exact);
            if (result.ec == std::errc() && std::isfinite(exact)) {
                return exact;
            }
        } else if (const auto* number = std::get_if<float>(&attribute.value);
                   number != nullptr && attribute.name == "viscera:time_s" && std::isfinite(*number)) {
            time = static_cast<double>(*number);
        }
    }
    return time;
}

/// The picture that is an energy: of a file with several, the one that is named so.
const io::ExrPart& energy_of(const std::vector<io::ExrPart>& parts, const std::string& file) {
    const auto named = std::ranges::find(parts, "tissue.energy", &io::ExrPart::name);
    if (named == parts.end() && parts.size() > 1) {
        throw Error(ErrorCode::scene, file, "holds several pictures, and none is named 'tissue.energy'");
    }
    const io::ExrPart& part = named == parts.end() ? parts.front() : *named;
    if (part.image.channels() != 1) {
        throw Error(ErrorCode::scene, file,
                    "'" + part.name + "' has " + std::to_string(part.image.channels()) +
                        " channels; an energy has one");
    }
    return part;
}

}  // namespace

void SavedEnergyParams::visit(ParamVisitor& v) {
    v.field({.name = "file", .doc = "EXR file of this target, as render --dump writes it; empty: none."},
            file);
    v.field(
        {.name = "time_s",
         .doc =
             "Time of that frame, from which it goes on: what contacts did until then is in it; by default "
             "as the file says.",
         .unit = "s"},
        time_s);
}

std::shared_ptr<const SavedEnergy> load_energy(Assets& assets, const SavedEnergyParams& params, int size) {
    const std::string name = params.file.path.string();
    const std::uint64_t key =
        Hash().add(assets.file_key(params.file.path)).add(params.time_s.value_or(-1.0)).add(size).value();
    return assets.shared<SavedEnergy>(key, [&] {
        const std::vector<io::ExrPart> parts = io::read_exr(params.file.path);
        const io::ExrPart& part = energy_of(parts, name);
        const Image& image = part.image;
        if (image.width != size || image.height != size) {
            throw Error(ErrorCode::scene, name,
                        "is " + size_text({image.width, image.height}) + " pixels, the state is " +
                            size_text(glm::ivec2(size)));
        }
        auto saved = std::make_shared<SavedEnergy>();
        saved->time_s = params.time_s ? params.time_s : time_of(part);
        saved->image = make_image(size, size, PixelFormat::r32f);
        std::uint64_t bad = 0;
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const float value = image.at(x, y, 0);
                bad += std::isfinite(value) ? 0 : 1;
                saved->image.set(x, y, 0, std::isfinite(value) ? value : 0.0F);
            }
        }
        if (bad > 0) {
            assets.log().fault(
                "tissue.saved_energy",
                name + ": " + std::to_string(bad) + " values are not finite and are taken as 0", bad);
        }
        return saved;
    });
}

}  // namespace viscera::tissue
