#include "effects/organ/hematoma.h"

#include <algorithm>
#include <utility>

#include "engine/core/finite.h"
#include "engine/core/hash.h"
#include "engine/core/pixel_index.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::organ {
namespace {

constexpr int columns = 1024;  // as glsl/organ/hematoma.glsl
// Sides of the cells that spots are listed by, unless that makes too long a list.
constexpr double cell_pixels = 32.0;
constexpr double cell_uv = 1.0 / 64.0;
constexpr std::size_t most_listed = std::size_t{1} << 20U;
constexpr double wider = 1.001;
constexpr double farthest_spot_mm = 1e15;

bool usable(const glm::dvec4& spot) {
    return finite(spot) && spot.w > 0.0;
}

}  // namespace

void Hematoma::gather(const HematomaParams& params, const HostValues* values, Log& log) {
    spots_.clear();
    for (const SpotParams& spot : params.spots) {
        spots_.emplace_back(spot.centre, spot.radius);
    }
    const HostValues::Entry* given =
        values == nullptr || params.host_spots.empty() ? nullptr : values->find(params.host_spots);
    key_ = Hash().add(given == nullptr ? std::uint64_t{0} : given->version).value();
    if (given != nullptr) {
        if (given->values.size() % 4 != 0) {
            log.fault("organ.host_spots", "host values '" + params.host_spots +
                                              "' are not 4 floats for each spot; the rest is left out");
        }
        for (std::size_t i = 0; i + 3 < given->values.size(); i += 4) {
            const float* v = given->values.data() + i;
            spots_.emplace_back(glm::dvec4(v[0], v[1], v[2], v[3]));
        }
    }
    if (const std::size_t faulty = std::erase_if(spots_, [](const auto& s) { return !usable(s); });
        faulty > 0) {
        log.fault("organ.spot", "hematoma spots that are not finite or have no radius are left out", faulty);
    }
    if (spots_.size() > most_spots) {
        log.fault("organ.spots",
                  "more than " + std::to_string(most_spots) + " hematoma spots; the rest is left out");
        spots_.resize(most_spots);
    }
}

/// Cells as small as a list of `most_listed` spots allows.
void Hematoma::find_ranges(const HematomaParams& params, const View& view, glm::ivec2 size) {
    const bool in_world = params.metric == SpotMetric::world;
    ranges_.resize(spots_.size());
    for (double cell = in_world ? cell_pixels : cell_uv;; cell *= 2.0) {
        cells_ = in_world ? glm::max(glm::ivec2(glm::ceil(glm::dvec2(size) / cell)), 1)
                          : glm::ivec2(static_cast<int>(std::max(1.0 / cell, 1.0)));
        cells_per_unit_ = glm::dvec2(1.0 / cell);
        const auto cell_of = [&](const glm::dvec2& at) {
            return glm::ivec2(
                glm::clamp(glm::floor(at * cells_per_unit_), glm::dvec2(0.0), glm::dvec2(cells_ - 1)));
        };
        std::size_t listed = 0;
        for (std::size_t i = 0; i < spots_.size(); ++i) {
            const glm::dvec3 centre(spots_[i]);
            // A little more than the radius, since shaders measure in floats.
            const double radius = spots_[i].w * wider;
            if (in_world) {
                // Within what floats can count in: spots may be as large as a double.
                const Bounds box{glm::vec3(glm::clamp(centre - radius, -farthest_spot_mm, farthest_spot_mm)),
                                 glm::vec3(glm::clamp(centre + radius, -farthest_spot_mm, farthest_spot_mm))};
                const PixelRect rect = project_bounds(box, view.view_projection(), size);
                const glm::dvec2 low(rect.x, rect.y);
                ranges_[i] = rect.empty() ? Range{}
                                          : Range{cell_of(low),
                                                  cell_of(low + glm::dvec2(rect.width - 1, rect.height - 1))};
            } else {
                ranges_[i] = {cell_of(glm::dvec2(centre) - radius), cell_of(glm::dvec2(centre) + radius)};
            }
            listed += ranges_[i].count();
        }
        if (listed <= most_listed || cells_ == glm::ivec2(1)) {
            return;
        }
    }
}

/// Spots of one cell follow each other.
void Hematoma::sort_into_cells(std::span<const glm::vec4> shader_spots) {
    const auto for_each_cell = [&](const Range& range, auto&& action) {
        for (int y = range.first.y; y <= range.last.y; ++y) {
            for (int x = range.first.x; x <= range.last.x; ++x) {
                action(pixel_index(x, y, cells_.x));
            }
        }
    };
    next_.assign(static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y), 0);
    for (const Range& range : ranges_) {
        for_each_cell(range, [&](std::size_t cell) { ++next_[cell]; });
    }
    cell_texels_.clear();
    std::uint32_t begin = 0;
    for (std::uint32_t& count : next_) {
        cell_texels_.emplace_back(begin, count);
        begin += std::exchange(count, begin);
    }
    const std::size_t rows = std::max<std::size_t>((begin + columns - 1) / columns, 1);
    const std::size_t there = texture_ ? static_cast<std::size_t>(texture_->height()) : 0;
    texels_.assign(std::max(rows, there) * columns, glm::vec4(0.0F));
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
        for_each_cell(ranges_[i], [&](std::size_t cell) { texels_[next_[cell]++] = shader_spots[i]; });
    }
}

void Hematoma::set(const Pass& pass, const gl::Program& program, const HematomaParams& params,
                   const View& view, const glm::dvec3& centre_in_eye) {
    find_ranges(params, view, pass.size());
    shader_spots_.resize(spots_.size());
    std::ranges::transform(spots_, shader_spots_.begin(), [&](const glm::dvec4& spot) {
        glm::dvec3 centre(spot);
        if (params.metric == SpotMetric::world) {
            centre = glm::dvec3(view.view * glm::dvec4(centre, 1.0)) - centre_in_eye;
        }
        return glm::vec4(glm::vec3(centre), static_cast<float>(std::min(1.0 / spot.w, 1e30)));
    });
    sort_into_cells(shader_spots_);
    const int rows = static_cast<int>(texels_.size() / columns);
    if (!texture_ || texture_->height() < rows) {
        texture_.emplace(
            gl::Texture::make_2d(pass.gl(), columns, rows, PixelFormat::rgba32f, "hematoma spots"));
    }
    texture_->upload(std::as_bytes(std::span(texels_)));
    if (!cell_texture_ || cell_texture_->width() != cells_.x || cell_texture_->height() != cells_.y) {
        cell_texture_.emplace(gl::Texture::make_2d(pass.gl(), cells_.x, cells_.y, PixelFormat::rg32f,
                                                   "cells of hematoma spots"));
    }
    cell_texture_->upload(std::as_bytes(std::span(cell_texels_)));
    pass.bind(program, "u_spots", *texture_, gl::Filter::nearest);
    pass.bind(program, "u_spot_cells", *cell_texture_, gl::Filter::nearest);
    program.set("u_cells_per_unit", glm::vec2(cells_per_unit_));
    program.set("u_hematoma", glm::vec4(glm::vec3(params.colour), static_cast<float>(params.strength)));
}

}  // namespace viscera::organ
