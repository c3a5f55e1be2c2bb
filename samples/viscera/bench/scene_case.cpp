#include "samples/viscera/bench/scene_case.h"

#include <fstream>

#include "engine/core/error.h"
#include "samples/viscera/bench/volume_scene.h"

namespace viscera::app {
namespace {

void write_pixels(const Image& image, const std::filesystem::path& file) {
    const std::vector<float> bottom_first = to_floats(image);
    const std::size_t row =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels());
    std::ofstream stream(file, std::ios::binary);
    for (std::size_t y = static_cast<std::size_t>(image.height); y-- > 0;) {
        const auto bytes = std::as_bytes(std::span(bottom_first).subspan(y * row, row));
        stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    if (!stream.flush()) {
        throw Error(ErrorCode::file, file.string(), "cannot write the pixels");
    }
}

}  // namespace

void run_scene(Lab& lab, const Scene& scene, const std::filesystem::path& pixels) {
    Stage stage(lab, scene,
                {.by_pass = false,
                 .time_s = scene.time_s,
                 .warm = lab.options().repeats == 1 ? std::optional(0) : std::nullopt});
    stage.run(nudge);
    lab.add({.group = "scene", .name = scene.name, .samples = stage.whole()});
    if (!pixels.empty() && !scene.outputs.empty()) {
        write_pixels(stage.read(scene.outputs.front()), pixels);
    }
}

}  // namespace viscera::app
