#include "tests/reference/volume_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace viscera::reference {
namespace {

/// Gauss points of two lie this share of the length to either side of the middle.
const double gauss_offset = 0.5 / std::numbers::sqrt3;

/// The field along a ray, by texture coordinates.
class Sampler {
  public:
    Sampler(const Field& field, const Ray& ray)
        : field_(field),
          origin_(field.world_to_texture() * glm::dvec4(ray.origin_mm, 1.0)),
          direction_(field.world_to_texture() * glm::dvec4(ray.direction, 0.0)) {}

    [[nodiscard]] glm::dvec3 texture(double s_mm) const { return origin_ + s_mm * direction_; }
    [[nodiscard]] double operator()(double s_mm) const { return field_.value(texture(s_mm)); }

  private:
    const Field& field_;
    glm::dvec3 origin_;
    glm::dvec3 direction_;
};

void put_behind(Light& light, const Light& slab) {
    light.colour += light.transmittance * slab.colour;
    light.transmittance *= slab.transmittance;
}

/// Calls use(value, slab) for the samples kept.
template <class Use>
void visit_samples(const Field& field, const Ray& ray, const Interval& interval, double step_mm,
                   std::optional<double> iso, Use&& use) {
    const Sampler sampler(field, ray);
    for (const Slab& slab : slabs(interval, step_mm)) {
        const double value = sampler(slab.sample);
        if (!iso || value >= *iso) {
            use(value, slab);
        }
    }
}

glm::dvec4 rgba_of(std::span<const double> channels) {
    switch (channels.size()) {
        case 1:
            return glm::dvec4(channels[0]);
        case 2:
            return {glm::dvec3(channels[0]), channels[1]};
        case 3:
            return {channels[0], channels[1], channels[2], (channels[0] + channels[1] + channels[2]) / 3.0};
        default:
            return {channels[0], channels[1], channels[2], channels[3]};
    }
}

}  // namespace

std::vector<Slab> slabs(const Interval& interval, double step_mm) {
    std::vector<Slab> result;
    const double length = interval.length();
    const auto whole = static_cast<std::size_t>(std::floor(length / step_mm + 1e-9));
    for (std::size_t k = 0; k < whole; ++k) {
        const auto n = static_cast<double>(k);
        result.push_back({interval.begin + n * step_mm, interval.begin + (n + 1.0) * step_mm,
                          interval.begin + (n + 0.5) * step_mm});
    }
    const double rest_begin = static_cast<double>(whole) * step_mm;
    if (length - rest_begin > 1e-9 * step_mm) {
        result.push_back(
            {interval.begin + rest_begin, interval.end, interval.begin + 0.5 * (rest_begin + length)});
    } else if (!result.empty()) {
        result.back().end = interval.end;
    }
    return result;
}

Light preintegrated_slab(double front_value, double back_value, double length_mm, const Medium& medium,
                         const Quality& quality) {
    Piece piece{{0.0, length_mm}, {}};
    piece.value.degree = 1;
    piece.value.c[0] = 0.5 * (front_value + back_value);
    piece.value.c[1] = 0.5 * (back_value - front_value);
    Light light;
    advance(light, piece, medium, quality);
    return light;
}

Light fourth_order_slab(const Emission& first, const Emission& second, double length_mm) {
    const double mean = 0.5 * (first.extinction + second.extinction);
    const double slope = std::numbers::sqrt3 * (second.extinction - first.extinction);
    const auto depth_at = [&](double u) {
        return length_mm * (mean * (u + 0.5) + 0.5 * slope * (u * u - 0.25));
    };
    Light light;
    light.colour = 0.5 * length_mm *
                   (first.extinction * std::exp(-depth_at(-gauss_offset)) * first.colour +
                    second.extinction * std::exp(-depth_at(gauss_offset)) * second.colour);
    light.transmittance = std::exp(-length_mm * mean);
    return light;
}

Light composite_on_lattice(const Field& field, const Ray& ray, const Interval& interval, double step_mm,
                           const Medium& medium, const LatticeOptions& options) {
    const Sampler sampler(field, ray);
    const auto emission_at = [&](double s_mm) {
        const double value = sampler(s_mm);
        if (options.iso && !(value >= *options.iso)) {
            return Emission{};
        }
        const Emission plain = medium.at(value);
        return options.shade ? options.shade(plain, value, sampler.texture(s_mm), ray) : plain;
    };
    const auto light_of = [&](const Slab& slab) -> Light {
        const double h = slab.length();
        switch (options.scheme) {
            case Scheme::midpoint: {
                const Emission e = emission_at(slab.sample);
                const double transmittance = std::exp(-e.extinction * h);
                return {-std::expm1(-e.extinction * h) * e.colour, transmittance};
            }
            case Scheme::preintegrated:
                return preintegrated_slab(sampler(slab.begin), sampler(slab.end), h, medium);
            case Scheme::fourth_order:
                break;
        }
        return fourth_order_slab(emission_at(slab.sample - gauss_offset * h),
                                 emission_at(slab.sample + gauss_offset * h), h);
    };
    Light light;
    for (const Slab& slab : slabs(interval, step_mm)) {
        put_behind(light, light_of(slab));
        if (light.alpha() > options.stop_alpha) {
            break;
        }
    }
    return light;
}

double xray_on_lattice(const Field& field, const Ray& ray, const Interval& interval, double step_mm,
                       const Medium& mu, Scheme scheme) {
    const Sampler sampler(field, ray);
    const auto mu_at = [&](double s_mm) { return mu.at(sampler(s_mm)).extinction; };
    double sum = 0.0;
    for (const Slab& slab : slabs(interval, step_mm)) {
        const double h = slab.length();
        if (scheme == Scheme::midpoint) {
            sum += h * mu_at(slab.sample);
        } else if (scheme == Scheme::fourth_order) {
            sum += 0.5 * h * (mu_at(slab.sample - gauss_offset * h) + mu_at(slab.sample + gauss_offset * h));
        } else {
            sum -= std::log(preintegrated_slab(sampler(slab.begin), sampler(slab.end), h, mu).transmittance);
        }
    }
    return std::exp(-sum);
}

std::optional<double> maximum_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                         double step_mm, std::optional<double> iso) {
    std::optional<double> best;
    visit_samples(field, ray, interval, step_mm, iso,
                  [&](double value, const Slab&) { best = std::max(best.value_or(value), value); });
    return best;
}

std::optional<double> minimum_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                         double step_mm, std::optional<double> iso) {
    std::optional<double> best;
    visit_samples(field, ray, interval, step_mm, iso,
                  [&](double value, const Slab&) { best = std::min(best.value_or(value), value); });
    return best;
}

std::optional<double> mean_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                      double step_mm, std::optional<double> iso) {
    double sum = 0.0;
    double length = 0.0;
    visit_samples(field, ray, interval, step_mm, iso, [&](double value, const Slab& slab) {
        sum += value * slab.length();
        length += slab.length();
    });
    return length > 0.0 ? std::optional(sum / length) : std::nullopt;
}

std::optional<Crossing> crossing_on_lattice(const Field& field, const Ray& ray, const Interval& interval,
                                            double step_mm, double iso) {
    const Sampler sampler(field, ray);
    std::optional<bool> inside;
    double before = 0.0;
    for (const Slab& slab : slabs(interval, step_mm)) {
        const bool now = sampler(slab.sample) >= iso;
        if (inside && *inside != now) {
            double a = before;
            double b = slab.sample;
            while (b - a > 1e-14 * step_mm) {
                const double middle = 0.5 * (a + b);
                if (!(middle > a && middle < b)) {
                    break;
                }
                (sampler(middle) >= iso) == now ? b = middle : a = middle;
            }
            return crossing_at(field, ray, 0.5 * (a + b), iso, now);
        }
        inside = now;
        before = slab.sample;
    }
    return {};
}

glm::dvec4 accumulate(std::span<const Field> channels, const Ray& ray, const Interval& interval,
                      double step_mm, const Accumulate& rule) {
    const std::size_t count = std::min<std::size_t>(channels.size(), 4);
    glm::dvec4 sum(0.0);
    if (count == 0) {
        return sum;
    }
    for (const Slab& slab : slabs(interval, step_mm)) {
        std::array<double, 4> values{};
        bool kept = true;
        for (std::size_t c = 0; c < count; ++c) {
            const auto axis = static_cast<glm::length_t>(c);
            values[c] = value_at(channels[c], ray, slab.sample);
            kept = kept && values[c] >= rule.low[axis] && values[c] <= rule.high[axis];
        }
        if (!kept) {
            continue;
        }
        const glm::dvec4 rgba = rgba_of(std::span(values).first(count));
        double a = std::clamp(rgba.a, 0.0, 1.0) * rule.opacity / rule.samples * (slab.length() / step_mm);
        glm::dvec3 colour = (glm::dvec3(rgba) + rule.brightness) * rule.contrast;
        if (rule.look) {
            rule.look(colour, a, ray.at(slab.sample));
        }
        const double weight = (1.0 - sum.a) * a;
        sum += weight * glm::dvec4(colour, 1.0);
        if (sum.a > rule.stop_alpha) {
            break;
        }
    }
    return sum;
}

glm::dvec4 density(const Field& field, const Ray& ray, const Interval& interval, double step_mm,
                   const TransferFunction& function, const Density& rule) {
    // The law of colours alone; where it has extinction, the density takes that extinction's place.
    const Medium medium(function);
    LatticeOptions options{.stop_alpha = rule.stop_alpha, .iso = rule.iso};
    const double extinction = -std::log1p(-rule.density) / rule.reference_length_mm;
    options.shade = [&](const Emission&, double value, const glm::dvec3&, const Ray&) {
        const Emission plain = medium.at(value * rule.scale);
        return plain.extinction > 0.0 ? Emission{extinction, plain.colour} : Emission{};
    };
    const Light light = composite_on_lattice(field, ray, interval, step_mm, medium, options);
    return {rule.brightness * light.colour, light.alpha()};
}

}  // namespace viscera::reference
