#include "engine/io/volume_shape_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/core/json_text.h"
#include "engine/io/volume_text.h"

namespace viscera::io {
namespace {

constexpr std::string_view prefix = "viscera_";
constexpr double full_circle_deg = 360.0;
constexpr double far_mm = 1e30;

/// A key that holds a number.
struct NumberKey {
    std::string_view name;
    double VolumeShape::*field;
    bool degrees;  ///< in the file, radians in the shape
    bool required;
    double low;
    double high;
    bool cylindrical;
    bool spherical;

    [[nodiscard]] bool belongs_to(VolumeKind kind) const {
        return kind == VolumeKind::cylindrical ? cylindrical : spherical;
    }
};

constexpr std::array<NumberKey, 6> number_keys{
    {{"viscera_r_min_mm", &VolumeShape::r_min_mm, false, false, 0.0, far_mm, true, true},
     {"viscera_r_max_mm", &VolumeShape::r_max_mm, false, true, 0.0, far_mm, true, true},
     {"viscera_first_angle_deg", &VolumeShape::first_angle_rad, true, false, -full_circle_deg,
      full_circle_deg, true, true},
     {"viscera_angle_deg", &VolumeShape::angle_rad, true, true, 0.0, full_circle_deg, true, true},
     {"viscera_height_mm", &VolumeShape::height_mm, false, true, 0.0, far_mm, true, false},
     {"viscera_latitude_deg", &VolumeShape::latitude_rad, true, true, 0.0, 180.0, false, true}}};

constexpr std::string_view geometry_key = "viscera_geometry";
constexpr std::string_view wrap_key = "viscera_wrap";

std::string known_keys() {
    std::string text = std::string(geometry_key) + ", " + std::string(wrap_key);
    for (const NumberKey& key : number_keys) {
        text += ", " + std::string(key.name);
    }
    return text;
}

VolumeKind kind_of(std::string_view text, const Reading& reading) {
    const auto names = choice_names(VolumeKind::cartesian);
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) {
        reading.fail(std::string(geometry_key) + ": '" + printable(text) +
                     "' is none of cartesian, cylindrical, spherical");
    }
    return static_cast<VolumeKind>(found - names.begin());
}

double number_of(const NumberKey& key, std::string_view text, const Reading& reading) {
    const double number = one_number(text, key.name, reading);
    if (!(number >= key.low && number <= key.high)) {
        reading.fail(std::string(key.name) + ": '" + printable(text) + "' is not between " +
                     number_text(key.low) + " and " + number_text(key.high));
    }
    return number;
}

/// Keys that nobody reads are mistakes: a misspelt one would leave its number at a default.
void check_names(const KeyValues& values, VolumeKind kind, bool has_geometry, const Reading& reading) {
    for (const auto& [name, value] : values) {
        if (!name.starts_with(prefix) || name == geometry_key) {
            continue;
        }
        const auto key = std::ranges::find(number_keys, name, &NumberKey::name);
        if (key == number_keys.end() && name != wrap_key) {
            reading.fail(printable(name) + " is no key of a geometry; there are " + known_keys());
        }
        if (!has_geometry) {
            reading.fail(name + " needs " + std::string(geometry_key) + ", which is missing");
        }
        if (kind == VolumeKind::cartesian || (key != number_keys.end() && !key->belongs_to(kind))) {
            reading.fail(name + " does not belong to a geometry that is " + std::string(to_string(kind)));
        }
    }
}

/// Degrees that read back as the same angle, where there are any, with as few digits as that takes.
std::string degrees_of(double angle_rad) {
    constexpr double per_radian = 57.295779513082320877;
    const double degrees = angle_rad * per_radian;
    // Whole and half degrees are what people give; a product may lie one digit beside.
    const double tidy = std::round(degrees * 1e9) / 1e9;
    return number_text(glm::radians(tidy) == angle_rad ? tidy : degrees);
}

}  // namespace

VolumeShape shape_of_keys(const KeyValues& values, const Reading& reading) {
    const auto geometry = values.find(geometry_key);
    const bool has_geometry = geometry != values.end();
    VolumeShape shape;
    shape.kind = has_geometry ? kind_of(geometry->second, reading) : VolumeKind::cartesian;
    check_names(values, shape.kind, has_geometry, reading);
    if (!shape.curvilinear()) {
        return shape;
    }
    for (const NumberKey& key : number_keys) {
        if (!key.belongs_to(shape.kind)) {
            continue;
        }
        const auto found = values.find(key.name);
        if (found != values.end()) {
            const double number = number_of(key, found->second, reading);
            shape.*key.field = key.degrees ? glm::radians(number) : number;
        } else if (key.required) {
            reading.fail(std::string(key.name) + " is missing");
        }
    }
    if (shape.r_max_mm < shape.r_min_mm) {
        reading.fail("viscera_r_max_mm is less than viscera_r_min_mm");
    }
    if (const auto wrap = values.find(wrap_key); wrap != values.end()) {
        if (wrap->second != "true" && wrap->second != "false") {
            reading.fail(std::string(wrap_key) + ": '" + printable(wrap->second) +
                         "' is neither true nor false");
        }
        shape.wrap = wrap->second == "true";
        if (shape.wrap && shape.angle_rad != glm::radians(full_circle_deg)) {
            reading.fail(std::string(wrap_key) + " needs a viscera_angle_deg of 360");
        }
    }
    return shape;
}

std::string keys_of(const VolumeShape& shape) {
    if (!shape.curvilinear()) {
        return "";
    }
    const auto line = [](std::string_view key, std::string_view value) {
        return std::string(key) + ":=" + std::string(value) + "\n";
    };
    std::string text = line(geometry_key, to_string(shape.kind));
    for (const NumberKey& key : number_keys) {
        if (key.belongs_to(shape.kind)) {
            const double value = shape.*key.field;
            text += line(key.name, key.degrees ? degrees_of(value) : number_text(value));
        }
    }
    return text + line(wrap_key, shape.wrap ? "true" : "false");
}

}  // namespace viscera::io
