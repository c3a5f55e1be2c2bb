#include "engine/core/scene_fields.h"

#include <limits>

namespace viscera {

std::span<const std::string_view> choice_names(PixelFormat /*format*/) {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> words;
        for (const FormatInfo& entry : all_formats()) {
            words.push_back(entry.name);
        }
        return words;
    }();
    return names;
}

void SceneFields::visit(ParamVisitor& v) {
    v.field({.name = "$schema", .doc = "Where the schema of scene files lies; for editors."}, schema);
    v.field({.name = "version", .doc = "Version of the format.", .min = 1, .max = 1, .required = true},
            version);
    v.field({.name = "name", .doc = "What to call the scene."}, name);
    v.field({.name = "description", .doc = "What the scene shows."}, description);
    v.field({.name = "resolution",
             .doc = "Width and height of the frame.",
             .unit = "pixels",
             .min = 1,
             .max = largest_side},
            resolution);
    v.field({.name = "time_s", .doc = "Time of the first frame.", .unit = "s"}, time_s);
    v.field({.name = "frames_per_second",
             .doc = "Frames per second of scene time.",
             .unit = "1/s",
             .min = 0.0,
             .max = 1e6,
             .min_excluded = true},
            frames_per_second);
    v.field({.name = "camera", .doc = "Where the scene is seen from."}, camera);
    v.field(
        {.name = "outputs", .doc = "Names of the targets wanted at the end of the frame.", .required = true},
        outputs);
    v.field({.name = "timeline",
             .doc = "What a host would tell effects as time passes: contacts, emitters, moved vertices."},
            timeline);
}

void SceneTargetFields::visit(ParamVisitor& v) {
    v.field({.name = "format", .doc = "Pixel format; without it, what the effect that writes it asks for."},
            format);
    v.field({.name = "scale",
             .doc = "Size as a fraction of the frame's.",
             .min = 0.0,
             .max = 4.0,
             .min_excluded = true},
            scale);
    v.field({.name = "size",
             .doc = "Width and height, whatever the frame's.",
             .unit = "pixels",
             .min = 1,
             .max = largest_side},
            size);
    constexpr double most = std::numeric_limits<float>::max();
    v.field({.name = "clear",
             .doc = "One to four values that the target is cleared to; those left out are 0.",
             .min = -most,
             .max = most},
            clear);
}

void ScenePassFields::visit(ParamVisitor& v) {
    v.field({.name = "name", .doc = "What to call the pass; no two alike.", .required = true}, name);
    v.field({.name = "effect", .doc = "The effect that the pass runs.", .required = true}, effect);
    v.field({.name = "enabled", .doc = "Whether the pass takes part."}, enabled);
}

}  // namespace viscera
