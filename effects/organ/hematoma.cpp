#include "effects/organ/hematoma.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/runtime/pass.h"

namespace viscera::organ {
namespace {

constexpr int columns = 256;

bool usable(const glm::dvec4& spot) {
    return std::isfinite(spot.x) && std::isfinite(spot.y) && std::isfinite(spot.z) && std::isfinite(spot.w) &&
           spot.w > 0.0;
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

void Hematoma::set(const Pass& pass, const gl::Program& program, const HematomaParams& params,
                   const View& view, const glm::dvec3& centre_in_eye) {
    const int rows = static_cast<int>((spots_.size() + columns - 1) / columns);
    if (!texture_ || texture_->height() < rows) {
        texture_.emplace(
            gl::Texture::make_2d(pass.gl(), columns, rows, PixelFormat::rgba32f, "hematoma spots"));
    }
    texels_.assign(static_cast<std::size_t>(texture_->height()) * columns, glm::vec4(0.0F));
    std::ranges::transform(spots_, texels_.begin(), [&](const glm::dvec4& spot) {
        glm::dvec3 centre(spot);
        if (params.metric == SpotMetric::world) {
            centre = glm::dvec3(view.view * glm::dvec4(centre, 1.0)) - centre_in_eye;
        }
        return glm::vec4(glm::vec3(centre), static_cast<float>(std::min(1.0 / spot.w, 1e30)));
    });
    texture_->upload(std::as_bytes(std::span(texels_)));
    pass.bind(program, "u_spots", *texture_, gl::Filter::nearest);
    program.set("u_spot_count", static_cast<int>(spots_.size()));
    program.set("u_spot_columns", columns);
    program.set("u_hematoma", glm::vec4(glm::vec3(params.colour), static_cast<float>(params.strength)));
}

}  // namespace viscera::organ
