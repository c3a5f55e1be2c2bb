#include "tests/reference/contrast.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace viscera::reference {
namespace {

double clamp01(double x) {
    return std::clamp(x, 0.0, 1.0);
}

double smoothstep(double low, double high, double x) {
    const double u = clamp01((x - low) / (high - low));
    return u * u * (3.0 - 2.0 * u);
}

std::optional<glm::dvec2> project(const glm::dmat4& view_projection, const glm::dvec3& point) {
    const glm::dvec4 p = view_projection * glm::dvec4(point, 1.0);
    if (!(p.w > 0.0) || !std::isfinite(p.x + p.y)) {
        return {};
    }
    return glm::dvec2(p) / p.w * 0.5 + 0.5;
}

double blend_views(const std::vector<SpriteView>& views, double angle_deg, glm::dvec2 uv) {
    if (views.empty()) {
        return 0.0;
    }
    const auto above = std::ranges::upper_bound(views, angle_deg, {}, &SpriteView::angle_deg);
    if (above == views.begin()) {
        return sample_inside(above->texture, uv);
    }
    const SpriteView& below = *(above - 1);
    const double near = sample_inside(below.texture, uv);
    if (above == views.end()) {
        return near;
    }
    const double weight = (angle_deg - below.angle_deg) / (above->angle_deg - below.angle_deg);
    return (1.0 - weight) * near + weight * sample_inside(above->texture, uv);
}

void draw_sprite(const Emitter& emitter, const Sprites& pictures, const SpriteCamera& camera,
                 const Buffer& summary, Buffer& target) {
    const auto base_uv = project(camera.view_projection, emitter.base_mm);
    const auto tip_uv = project(camera.view_projection, emitter.tip_mm);
    const auto edge_uv = project(camera.view_projection, emitter.edge_mm);
    if (!base_uv || !tip_uv || !edge_uv || !(emitter.size > 0.0)) {
        return;
    }
    // Lengths in target heights, so that a sprite keeps its shape on a target that is not square.
    const glm::dvec2 aspect(static_cast<double>(target.width) / target.height, 1.0);
    const glm::dvec2 base = *base_uv * aspect;
    const glm::dvec2 tip = *tip_uv * aspect;
    const glm::dvec2 edge = *edge_uv * aspect;
    if (emitter.tip_mm == emitter.base_mm) {
        return;
    }
    const double length = glm::length(tip - base);
    const bool has_side = length * target.height > 1e-3;
    const glm::dvec2 up = has_side ? (tip - base) / length : glm::dvec2(0.0);
    const glm::dvec2 right(up.y, -up.x);
    const glm::dvec3 axis = glm::normalize(emitter.tip_mm - emitter.base_mm);
    const glm::dvec3 sight = camera.orthographic ? glm::normalize(camera.forward)
                                                 : glm::normalize(emitter.base_mm - camera.eye_mm);
    const double k = std::min(1.0, std::abs(glm::dot(axis, sight)));
    const double angle_deg = std::acos(k) * 180.0 / std::numbers::pi;
    const double front_weight = clamp01(4.0 * k - 3.0);
    const double front_size = 5.5 * glm::length(tip - edge);
    const double brightness = emitter.strength * sprite_brightness(summary, *base_uv);
    for (int y = 0; y < target.height; ++y) {
        for (int x = 0; x < target.width; ++x) {
            const glm::dvec2 uv = target.uv(x, y);
            const glm::dvec2 place = uv * aspect;
            const glm::dvec2 d = place - base;
            double smoke = 0.0;
            if (has_side) {
                const glm::dvec2 side_uv =
                    glm::dvec2(glm::dot(right, d), glm::dot(up, d)) / (emitter.size * length) +
                    glm::dvec2(0.55, 0.15);
                smoke = blend_views(pictures.views, angle_deg, side_uv);
            }
            if (front_weight > 0.0 && front_size > 0.0) {
                smoke += 1.1 * front_weight * sample_inside(pictures.front, (place - tip) / front_size + 0.5);
            }
            const double sharp = pictures.mask_sharp.empty() ? 1.0 : sample_linear(pictures.mask_sharp, uv);
            const double blurred =
                pictures.mask_blurred.empty() ? 1.0 : sample_linear(pictures.mask_blurred, uv);
            const double further = has_side ? clamp01(glm::length(d) / (0.3 * length)) : 1.0;
            const double mask = std::lerp(sharp, blurred, further);
            target.at(x, y) = std::max(target.at(x, y), clamp01(2.0 * mask * smoke * brightness));
        }
    }
}

Buffer blur_axis(const Buffer& in, const std::vector<double>& kernel, int dx, int dy) {
    const int radius = static_cast<int>(kernel.size()) - 1;
    Buffer out(in.width, in.height);
    for (int y = 0; y < in.height; ++y) {
        for (int x = 0; x < in.width; ++x) {
            for (int i = -radius; i <= radius; ++i) {
                out.at(x, y) +=
                    kernel[static_cast<std::size_t>(std::abs(i))] *
                    in.at(std::clamp(x + i * dx, 0, in.width - 1), std::clamp(y + i * dy, 0, in.height - 1));
            }
        }
    }
    return out;
}

}  // namespace

double opacity_loop(double a, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double part = static_cast<double>(i) / n;
        sum += clamp01(2.0 * (a - part) / (1.0 - part));
    }
    return std::min(1.0, sum);
}

Buffer main_object(const ContrastMesh& mesh, const ContrastView& view, const DensityAt& density,
                   double tone) {
    Buffer out(view.raster.width, view.raster.height);
    rasterise(mesh.positions_mm, mesh.indices, view.view_projection, view.raster, [&](const Fragment& f) {
        const double raw = density(f);
        const double a = std::isnan(raw) ? 0.0 : clamp01(raw);
        out.at(f.x, f.y) = std::max(out.at(f.x, f.y), tone * a * opacity_loop(a));
    });
    return out;
}

Buffer thick_object(const ContrastMesh& mesh, const ContrastView& view, const DensityAt& density,
                    const DensityAt& way_mm, double calibre_mm, double tone) {
    Buffer out(view.raster.width, view.raster.height);
    rasterise(mesh.positions_mm, mesh.indices, view.view_projection, view.raster, [&](const Fragment& f) {
        const double a = clamp01(density(f));
        out.at(f.x, f.y) += tone * a * opacity_loop(a) * std::abs(way_mm(f)) / calibre_mm;
    });
    return out;
}

double injection_weight(const Injection& injection, const glm::dvec3& place_mm) {
    if (!(injection.radius_mm > 0.0) || !std::isfinite(injection.radius_mm)) {
        return 0.0;
    }
    return clamp01(3.0 * (1.0 - glm::distance(place_mm, injection.position_mm) / injection.radius_mm));
}

Buffer cloud(const ContrastMesh& mesh, const ContrastView& view, const Injection& injection) {
    Buffer out(view.raster.width, view.raster.height, 2);
    rasterise(mesh.positions_mm, mesh.indices, view.view_projection, view.raster, [&](const Fragment& f) {
        const double q = injection_weight(injection, f.interpolate(mesh.positions_mm));
        const double c = injection.brightness * q;
        if (c >= injection.threshold && q > out.at(f.x, f.y, 1)) {
            out.at(f.x, f.y, 0) = c;
            out.at(f.x, f.y, 1) = q;
        }
    });
    return out;
}

Buffer distance_map(const ContrastMesh& mesh, const ContrastView& view, const Injection& injection) {
    Buffer out(view.raster.width, view.raster.height, 2);
    rasterise(mesh.positions_mm, mesh.indices, view.view_projection, view.raster, [&](const Fragment& f) {
        const double q = injection_weight(injection, f.interpolate(mesh.positions_mm));
        out.at(f.x, f.y, 0) = std::max(out.at(f.x, f.y, 0), q);
        out.at(f.x, f.y, 1) = 1.0;
    });
    return out;
}

Buffer summarize(const Buffer& main, const Buffer& cloud, const Buffer& distance, Transition transition) {
    constexpr double width = 0.05;
    Buffer out(main.width, main.height);
    for (int y = 0; y < main.height; ++y) {
        for (int x = 0; x < main.width; ++x) {
            const double m = main.at(x, y);
            const double r = std::lerp(m, cloud.at(x, y, 0), cloud.at(x, y, 1));
            const double excess = 0.9 * m - r;
            if (transition == Transition::densest) {
                out.at(x, y) = std::max(m, r);
                continue;
            }
            const bool smooth = transition == Transition::smooth;
            const double amount = smooth ? smoothstep(-width, width, excess) : (excess > 0.0 ? 1.0 : 0.0);
            out.at(x, y) = distance.at(x, y) > 0.0 ? std::lerp(r, 0.5 * (r + m), amount) : r;
        }
    }
    return out;
}

double sprite_brightness(const Buffer& summary, glm::dvec2 base_uv) {
    double brightest = sample_linear(summary, base_uv);
    for (int ring = 1; ring <= 4; ++ring) {
        const double step = 0.01 * ring;
        for (const glm::dvec2 offset :
             {glm::dvec2(-step, 0.0), glm::dvec2(step, 0.0), glm::dvec2(0.0, -step), glm::dvec2(0.0, step)}) {
            brightest = std::max(brightest, sample_linear(summary, base_uv + offset));
        }
    }
    return brightest;
}

Buffer sprites(std::span<const Emitter> emitters, const Sprites& pictures, const SpriteCamera& camera,
               const Buffer& summary) {
    Buffer target(summary.width, summary.height);
    for (const Emitter& emitter : emitters) {
        draw_sprite(emitter, pictures, camera, summary, target);
    }
    return target;
}

Buffer capillary(const Buffer& delayed_main, double sigma_pixels, double gain) {
    std::vector<double> kernel{1.0};
    if (sigma_pixels > 0.0) {
        const int radius = static_cast<int>(std::ceil(3.0 * sigma_pixels));
        double sum = 1.0;
        for (int i = 1; i <= radius; ++i) {
            kernel.push_back(std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels)));
            sum += 2.0 * kernel.back();
        }
        for (double& weight : kernel) {
            weight /= sum;
        }
    }
    Buffer out = blur_axis(blur_axis(delayed_main, kernel, 1, 0), kernel, 0, 1);
    for (double& value : out.data) {
        value = clamp01(gain * value);
    }
    return out;
}

double extinction_for(double darkest) {
    return -std::log(darkest);
}

double tone_contrast(double background, double ratio, Tone tone, double mu) {
    if (tone == Tone::beer_lambert) {
        return background * std::exp(-mu * ratio);
    }
    return ratio < 0.5 ? std::lerp(background, 0.1, 2.0 * ratio) : 0.15 * ratio;
}

Buffer composite(const Buffer& background, std::span<const Buffer> layers, int width, int height, Tone tone,
                 double mu) {
    Buffer out(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double ratio = 0.0;
            for (const Buffer& layer : layers) {
                ratio = std::max(ratio, layer.at(x, y));
            }
            out.at(x, y) = tone_contrast(sample_linear(background, out.uv(x, y)), ratio, tone, mu);
        }
    }
    return out;
}

}  // namespace viscera::reference
