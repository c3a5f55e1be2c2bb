#include "samples/viscera/slice_hand.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "effects/volume/slice_params.h"
#include "engine/core/params_json.h"
#include "engine/io/volume.h"

namespace viscera::app {

const ScenePass* SliceHand::pass_of(std::string_view target) const {
    const std::vector<ScenePass>& passes = renderer_.scene().passes;
    const auto found = std::ranges::find_if(passes, [&](const ScenePass& pass) {
        const auto colour = pass.targets.find("colour");
        return pass.effect == "volume.slice" &&
               target == (colour == pass.targets.end() ? "volume.slice" : colour->second);
    });
    return found == passes.end() ? nullptr : &*found;
}

SliceHand::Plane SliceHand::find(const ScenePass& pass) {
    volume::SliceParams params;
    std::vector<JsonFault> faults;  // none: the renderer has taken the scene
    read_params(
        pass.parameters, "", renderer_.scene().file.parent_path(), [&](ParamVisitor& v) { params.visit(v); },
        faults);
    const VolumeGrid grid =
        io::load_volume(params.volume.file.path, {.reduce = params.volume.reduce}, renderer_.log()).grid;
    const glm::dmat4 to_world = volume::placed(grid, params.volume.placement);
    const volume::SlicePlane cut = volume::slice_plane(params.plane, to_world);
    Plane plane{.oblique = params.plane.oblique.has_value(), .given_mm = cut.centre_mm};
    glm::dvec3 along = cut.normal();
    if (!plane.oblique) {
        plane.axis = params.plane.axis == volume::SliceAxis::axial     ? 2
                     : params.plane.axis == volume::SliceAxis::coronal ? 1
                                                                       : 0;
        along = glm::dvec3(0.0);
        along[plane.axis] = 1.0;
    }
    // One voxel along the volume's axis that lies nearest to the plane's normal.
    double share = -1.0;
    for (int a = 0; a < 3; ++a) {
        const glm::dvec3 voxel = glm::dvec3(to_world[a]) / static_cast<double>(grid.dims[a]);
        const double along_it = std::abs(glm::dot(voxel, along));
        if (along_it > share * glm::length(voxel)) {
            share = along_it / glm::length(voxel);
            plane.step_mm = along_it * along;
        }
    }
    return plane;
}

void SliceHand::scroll(std::string_view target, double voxels) {
    const ScenePass* pass = pass_of(target);
    const auto file = pass == nullptr ? nlohmann::json()
                                      : pass->parameters.value(nlohmann::json::json_pointer("/volume/file"),
                                                               nlohmann::json());
    if (!file.is_string() || file.get<std::string>().empty()) {
        return;  // a host's volume, which the app has none of
    }
    const std::string name = pass->name;
    auto found = planes_.find(name);
    if (found == planes_.end()) {
        found = planes_.emplace(name, find(*pass)).first;
    }
    set(name, found->second, found->second.moved + voxels);
}

void SliceHand::reset() {
    for (auto& [pass, plane] : planes_) {
        set(pass, plane, 0.0);
    }
}

void SliceHand::set(const std::string& pass, Plane& plane, double moved) {
    plane.moved = moved;
    const glm::dvec3 at = plane.given_mm + moved * plane.step_mm;
    if (plane.oblique) {
        renderer_.set_parameter(pass, "/plane/oblique/point_mm", nlohmann::json{at.x, at.y, at.z});
    } else {
        renderer_.set_parameter(pass, "/plane/position_mm", at[plane.axis]);
    }
    ++revision_;
}

}  // namespace viscera::app
