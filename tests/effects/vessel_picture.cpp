#include "tests/effects/vessel_picture.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "engine/core/params_json.h"
#include "engine/runtime/assets.h"

namespace viscera::test {

VesselPicture::VesselPicture(const nlohmann::json& parameters, const View& view, int width, int height) {
    std::vector<JsonFault> faults;
    const auto scenes = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes";
    read_params(
        parameters, "", scenes, [&](ParamVisitor& v) { params_.visit(v); }, faults);
    if (!faults.empty()) {
        throw std::invalid_argument(faults.front().pointer + ": " + faults.front().message);
    }
    Log log;
    Assets assets(log);
    vessel_ = contrast::load_vessel(assets, params_.vessel);
    mesh_.positions_mm.assign(vessel_->mesh.positions.begin(), vessel_->mesh.positions.end());
    mesh_.indices = vessel_->mesh.indices;
    eye_ = view;
    view_projection_ = view.view_projection();
    view_.raster = {.width = width, .height = height, .snap_bits = 8};
    shift(glm::dvec2(0.0));
    coverage_ = reference::distance_map(mesh_, view_, injection(1.0));
}

void VesselPicture::shift(const glm::dvec2& pixels) {
    glm::dmat4 in_clip(1.0);
    // x + shift * w, so that the shift survives the division by w.
    in_clip[3][0] = 2.0 * pixels.x / view_.raster.width;
    in_clip[3][1] = 2.0 * pixels.y / view_.raster.height;
    view_.view_projection = in_clip * view_projection_;
}

reference::Injection VesselPicture::injection(double brightness) const {
    return {.position_mm = vessel_->injection_mm,
            .radius_mm = params_.cloud.radius_mm,
            .brightness = brightness,
            .threshold = params_.cloud.threshold};
}

reference::Buffer VesselPicture::main(const Density& density, double tone) const {
    const std::vector<double> scalar(vessel_->scalar.begin(), vessel_->scalar.end());
    const std::vector<double> weight(vessel_->weight.begin(), vessel_->weight.end());
    return reference::main_object(
        mesh_, view_,
        [&](const reference::Fragment& f) {
            return density(f.interpolate(scalar)) * (weight.empty() ? 1.0 : f.interpolate(weight));
        },
        tone);
}

reference::Buffer VesselPicture::thickness(const Density& density, double tone) const {
    const std::vector<double> scalar(vessel_->scalar.begin(), vessel_->scalar.end());
    // In the cross-section as the ray sees it, then along the ray: 1 / sin of its slant to the axis, which
    // counts as 0.3 at least.
    std::vector<double> way;
    for (std::size_t v = 0; v < scalar.size(); ++v) {
        const glm::dvec3 axis(vessel_->tubes.axis[v]);
        const glm::dvec3 sight = eye_.direction_to(mesh_.positions_mm[v]);
        const glm::dvec3 across = sight - glm::dot(sight, axis) * axis;
        const double slant = glm::length(across);
        way.push_back(glm::dot(glm::dvec3(vessel_->tubes.offset_mm[v]), across) /
                      (std::max(slant, 1e-4) * std::max(slant, 0.3)));
    }
    return reference::thick_object(
        mesh_, view_, [&](const reference::Fragment& f) { return density(f.interpolate(scalar)); },
        [&](const reference::Fragment& f) { return f.interpolate(way); }, params_.vessel.full_calibre_mm,
        tone);
}

reference::Buffer VesselPicture::main_of(std::span<const float> vertex_density, double tone) const {
    const std::vector<double> scalar(vertex_density.begin(), vertex_density.end());
    return reference::main_object(
        mesh_, view_, [&](const reference::Fragment& f) { return f.interpolate(scalar); }, tone);
}

reference::Buffer VesselPicture::cloud(double brightness) const {
    return reference::cloud(mesh_, view_, injection(brightness));
}

reference::Buffer VesselPicture::distance() const {
    // As the target holds it: -1 beside the vessel.
    const reference::Buffer map = reference::distance_map(mesh_, view_, injection(1.0));
    reference::Buffer out(map.width, map.height);
    for (int y = 0; y < out.height; ++y) {
        for (int x = 0; x < out.width; ++x) {
            out.at(x, y) = map.at(x, y, 1) > 0.0 ? map.at(x, y, 0) : -1.0;
        }
    }
    return out;
}

IsCompared VesselPicture::agreed(const Image& distance) const {
    return [this, &distance](int x, int y) {
        return (distance.at(x, y, 0) >= 0.0F) == (coverage_.at(x, y, 1) > 0.0);
    };
}

double bolus_density(const contrast::BolusParams& bolus, double since_arrival_s) {
    const double x = since_arrival_s;
    if (!bolus.table.empty()) {
        double density = x < bolus.table.front().time_s ? 0.0 : bolus.table.back().density;
        for (std::size_t i = 0; i + 1 < bolus.table.size(); ++i) {
            const contrast::BolusPoint& a = bolus.table[i];
            const contrast::BolusPoint& b = bolus.table[i + 1];
            if (x >= a.time_s && x < b.time_s) {
                density = a.density + (b.density - a.density) * (x - a.time_s) / (b.time_s - a.time_s);
            }
        }
        return density;
    }
    const double u = std::clamp(x / bolus.rise_s, 0.0, 1.0);
    const double left = std::exp(-std::max(0.0, x - bolus.duration_s) / bolus.washout_s);
    return bolus.amplitude * u * u * (3.0 - 2.0 * u) * std::max(0.0, (4096.0 * left - 1.0) / 4095.0);
}

}  // namespace viscera::test
