#include "engine/io/colour_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace viscera::io {
namespace {

using std::numbers::pi;
const glm::dvec3 white_d65(0.9505, 1.0, 1.089);
// IEC 61966-2-1, linear sRGB to XYZ and back; given by columns.
const glm::dmat3 rgb_to_xyz(0.4124, 0.2126, 0.0193, 0.3576, 0.7152, 0.1192, 0.1805, 0.0722, 0.9505);
const glm::dmat3 xyz_to_rgb(3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570);

double decode(double c) {
    return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
}

double encode_srgb(double c) {
    return c > 0.0031308 ? 1.055 * std::pow(c, 1.0 / 2.4) - 0.055 : 12.92 * c;
}

template <class F>
glm::dvec3 each(const glm::dvec3& v, const F& f) {
    return {f(v.x), f(v.y), f(v.z)};
}

glm::dvec3 to_lab(const glm::dvec3& rgb) {
    const glm::dvec3 f = each(rgb_to_xyz * each(rgb, decode) / white_d65, [](double c) {
        return c > 0.008856 ? std::cbrt(c) : 7.787 * c + 16.0 / 116.0;
    });
    return {116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z)};
}

/// What is out of gamut is darkened until it fits, and cut at 0.
glm::dvec3 from_lab(const glm::dvec3& lab) {
    const double y = (lab.x + 16.0) / 116.0;
    const glm::dvec3 xyz =
        white_d65 * each(glm::dvec3(y + lab.y / 500.0, y, y - lab.z / 200.0), [](double f) {
            const double cube = f * f * f;
            return cube > 0.008856 ? cube : (f - 16.0 / 116.0) / 7.787;
        });
    const glm::dvec3 rgb = each(xyz_to_rgb * xyz, encode_srgb);
    return rgb / std::max({rgb.x, rgb.y, rgb.z, 1.0});
}

/// Hue, saturation, value, each in [0, 1].
glm::dvec3 to_hsv(const glm::dvec3& rgb) {
    const double most = std::max({rgb.x, rgb.y, rgb.z});
    const double range = most - std::min({rgb.x, rgb.y, rgb.z});
    if (!(range > 0.0)) {
        return {0.0, 0.0, most};
    }
    double hue = 0.0;
    if (rgb.x == most) {
        hue = (rgb.y - rgb.z) / range;
    } else if (rgb.y == most) {
        hue = 2.0 + (rgb.z - rgb.x) / range;
    } else {
        hue = 4.0 + (rgb.x - rgb.y) / range;
    }
    return {hue < 0.0 ? hue / 6.0 + 1.0 : hue / 6.0, range / most, most};
}

glm::dvec3 from_hsv(const glm::dvec3& hsv) {
    const auto component = [&](double offset) {
        const double k = std::fmod(offset + hsv.x * 6.0 + 6.0, 6.0);
        return hsv.z * (1.0 - hsv.y * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
    };
    return {component(5.0), component(3.0), component(1.0)};
}

glm::dvec3 mix_hsv(glm::dvec3 a, glm::dvec3 b, double t, bool wrapped) {
    if (wrapped && std::abs(a.x - b.x) > 0.5) {
        (a.x > b.x ? a.x : b.x) -= 1.0;
    }
    return from_hsv(a * (1.0 - t) + b * t);
}

/// Magnitude, saturation (angle from grey) and hue of a CIELAB colour.
struct Msh {
    double m, s, h;
};

Msh to_msh(const glm::dvec3& lab) {
    const double m = glm::length(lab);
    const double s = m > 0.001 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0.0;
    return {m, s, s > 0.001 ? std::atan2(lab.z, lab.y) : 0.0};
}

glm::dvec3 from_msh(const Msh& c) {
    return {c.m * std::cos(c.s), c.m * std::sin(c.s) * std::cos(c.h), c.m * std::sin(c.s) * std::sin(c.h)};
}

double angle_between(double a, double b) {
    const double angle = std::fmod(std::abs(a - b), 2.0 * pi);
    return std::min(angle, 2.0 * pi - angle);
}

/// Hue for a grey of magnitude m, so that the way from the colour to it changes evenly.
double hue_for_grey(const Msh& colour, double m) {
    if (colour.m >= m - 0.1) {
        return colour.h;
    }
    const double spin = colour.s * std::sqrt(m * m - colour.m * colour.m) / (colour.m * std::sin(colour.s));
    return colour.h > -0.3 * pi ? colour.h + spin : colour.h - spin;
}

glm::dvec3 mix_diverging(const glm::dvec3& first, const glm::dvec3& second, double t) {
    constexpr double grey = 0.05;
    Msh a = to_msh(to_lab(first));
    Msh b = to_msh(to_lab(second));
    if (a.s > grey && b.s > grey && angle_between(a.h, b.h) > 0.33 * pi) {
        const Msh middle{std::max({a.m, b.m, 88.0}), 0.0, 0.0};
        (t < 0.5 ? b : a) = middle;
        t = t < 0.5 ? 2.0 * t : 2.0 * t - 1.0;
    }
    if (a.s < grey && b.s > grey) {
        a.h = hue_for_grey(b, a.m);
    } else if (b.s < grey && a.s > grey) {
        b.h = hue_for_grey(a, b.m);
    }
    return from_lab(from_msh({std::lerp(a.m, b.m, t), std::lerp(a.s, b.s, t), std::lerp(a.h, b.h, t)}));
}

glm::dvec3 mix_unclamped(ColourSpace space, const glm::dvec3& a, const glm::dvec3& b, double t) {
    switch (space) {
        case ColourSpace::hsv:
        case ColourSpace::hsv_wrapped:
            return mix_hsv(to_hsv(a), to_hsv(b), t, space == ColourSpace::hsv_wrapped);
        case ColourSpace::lab:
            return from_lab(to_lab(a) * (1.0 - t) + to_lab(b) * t);
        case ColourSpace::diverging:
            return mix_diverging(a, b, t);
        case ColourSpace::rgb:
            break;
    }
    return a * (1.0 - t) + b * t;
}

}  // namespace

glm::dvec3 mix_colours(ColourSpace space, const glm::dvec3& a, const glm::dvec3& b, double t) {
    return glm::clamp(mix_unclamped(space, a, b, t), 0.0, 1.0);
}

}  // namespace viscera::io
