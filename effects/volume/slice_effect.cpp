#include "effects/volume/slice_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/volume/prefilter.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::volume {

std::vector<Port> SliceEffect::ports() const {
    std::vector<Port> ports{{.name = "colour",
                             .access = Access::write,
                             .target = "volume.slice",
                             .doc = "Colour of the values, premultiplied by opacity: 1 where the volume is.",
                             .format = PixelFormat::rgba16f,
                             .overwrites = !in_camera()}};
    if (in_camera()) {
        ports.push_back({.name = "depth",
                         .access = Access::write,
                         .target = "volume.slice_depth",
                         .doc = "Depth of the cut; 1 where there is none.",
                         .format = PixelFormat::depth32f,
                         .clear = {1.0F, 0.0F, 0.0F, 0.0F}});
    }
    return ports;
}

std::span<const ProgramDesc> SliceEffect::programs() const {
    ProgramDesc program{in_camera() ? "volume/limits.vert" : "common/fullscreen.vert", "volume/slice.frag",
                        params_.sampling.defines()};
    program.defines.emplace_back("TRANSFER_LINEAR");
    program.defines.push_back("SLAB " + std::to_string(static_cast<int>(params_.slab.function)));
    if (in_camera()) {
        program.defines.emplace_back("CAMERA");
    }
    programs_.clear();
    variants_.clear();
    for (const VolumeKind kind : {VolumeKind::cartesian, VolumeKind::cylindrical, VolumeKind::spherical}) {
        if (params_.volume.geometry && params_.volume.geometry->kind != kind) {
            continue;
        }
        for (const bool atlas : {false, true}) {
            if (atlas && params_.volume.storage == Storage::texture_3d) {
                continue;
            }
            programs_.push_back(program);
            std::vector<std::string>& defines = programs_.back().defines;
            const std::vector<std::string> own = coordinate_defines(kind);
            defines.insert(defines.end(), own.begin(), own.end());
            if (atlas) {
                defines.emplace_back("STORAGE_ATLAS");
            }
            variants_.emplace_back(kind, atlas);
        }
    }
    return programs_;
}

void SliceEffect::find_surface(Prepare& prepare) {
    const glm::dmat4 box = space_.box_to_world();
    plane_ = slice_plane(params_.plane, box);
    surface_ = {};
    if (in_camera() && params_.mesh.empty()) {
        surface_ = cut_polygon(plane_, box);
        for (glm::vec3& position : surface_.positions) {  // of the unit box
            position = space_.low + glm::dvec3(position) * (space_.high - space_.low);
        }
    } else if (in_camera()) {
        surface_ = params_.mesh.in_local(space_.local_to_world, prepare.log());
    }
    bounds_ = surface_.bounds();
    surface_key_ =
        Hash().add(parameters_key_).add(space_.local_to_world).add(space_.low).add(space_.high).value();
}

Work SliceEffect::prepare(Prepare& prepare) {
    source_ = load_source(prepare.assets(), params_.volume, prepare.frame());
    if (!source_) {
        return Work::idle("the host gives no volume of this name");
    }
    const bool coefficients = params_.sampling.uses_coefficients();
    sampled_channel_ = coefficients ? 0 : params_.volume.channel;
    sampled_ = coefficients ? load_coefficients(prepare.assets(), *source_, params_.volume.channel) : source_;
    const VolumeGrid& grid = source_->volume().grid;
    if (parameters_key_ != prepare.parameters_key() || !(grid_ == grid)) {
        function_ = load_function(params_.transfer_function, prepare.assets());
        space_ = make_space(grid, params_.volume.placement);
        if (invertible(space_.local_to_world)) {
            find_surface(prepare);
        }
        grid_ = grid;
        parameters_key_ = prepare.parameters_key();
    }
    if (space_.shape.flat()) {
        prepare.log().fault("volume.flat", source_->volume().source + ": an extent is 0; it is not drawn");
        return Work::idle("the volume encloses nothing");
    }
    if (!invertible(space_.local_to_world)) {
        prepare.log().fault("volume.singular", "the volume's placement is singular; it is not drawn");
        return Work::idle("the volume's placement is singular");
    }
    const std::uint64_t key = Hash().add(surface_key_).add(parameters_key_).add(source_->state_key()).value();
    if (!in_camera()) {
        return Work::all(key);
    }
    if (surface_.indices.empty()) {
        return Work::idle(params_.mesh.empty() ? "the plane misses the volume" : "the mesh has no triangles");
    }
    const View& view = prepare.frame().eye();
    const PixelRect region =
        project_bounds(bounds_, view.view_projection() * space_.local_to_world, prepare.size("colour"));
    if (region.empty()) {
        return Work::idle("the slice lies outside the view");
    }
    return Work::in_region(region, "only where the slice can be seen",
                           Hash().add(key).add(view.view).add(view.projection).value());
}

void SliceEffect::make_table(const gl::Functions& gl, const TexelMap& stored_of_texel) {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope * stored_of_texel.scale, volume.value_of(stored_of_texel.offset)};
    const VolumeStatistics& values = source_->statistics;
    TransferFunction function = function_;
    if (params_.transfer_function.empty()) {
        function = make_window({values.max - values.min, 0.5 * (values.min + values.max)});
    }
    // A window is often narrow beside the volume's range, and constant beyond its ends. Cubic filters leave
    // the range of the voxels.
    const double beyond = params_.sampling.is_tricubic() ? 0.5 * (values.max - values.min) : 0.0;
    double low = std::max(values.min - beyond, function.points.front().value);
    double high = std::min(values.max + beyond, function.points.back().value);
    if (!(low < high)) {
        low = values.min;
        high = values.max;
    }
    const double a = map.texel_of(low);
    const double b = map.texel_of(high);
    const TexelRange range{std::min(a, b), std::max(a, b)};
    const int entries = params_.transfer_function.entries;
    const ExtinctionKnots knots = extinction_knots(function, map, range);
    table_.make(gl, tabulate(knots, range, entries), parameters_key_, *source_);
}

void SliceEffect::set_plane(const Pass& pass, const gl::Program& program) const {
    const glm::dmat4 to_local = glm::inverse(space_.local_to_world);
    const glm::dvec3 per_mm = to_local * glm::dvec4(plane_.normal(), 0.0);
    // Voxels along the normal; those of a curvilinear volume run every way.
    const glm::dvec3 voxels_per_mm = space_.shape.curvilinear() ? glm::dvec3(1.0 / voxel_spacing_mm(space_))
                                                                : per_mm * glm::dvec3(grid_.dims);
    program.set("u_slab_samples", slab_samples(params_.slab, voxels_per_mm));
    program.set("u_slab_extent", glm::vec3(per_mm * params_.slab.thickness_mm));
    if (in_camera()) {
        return;
    }
    const glm::dvec2 size(pass.size());
    const double height = params_.height_mm > 0.0
                              ? params_.height_mm
                              : fitting_height_mm(plane_, space_.box_to_world(), size.x / size.y);
    const std::array<glm::vec3, 3> point{
        glm::vec3(to_local * glm::dvec4(plane_.centre_mm, 1.0)),
        glm::vec3(to_local * glm::dvec4(plane_.right * (0.5 * height * size.x / size.y), 0.0)),
        glm::vec3(to_local * glm::dvec4(plane_.up * (0.5 * height), 0.0))};
    program.set("u_point", std::span<const glm::vec3>(point));
    program.set("u_pixel", 2.0F / glm::vec2(pass.size()));
    const glm::dvec4& b = params_.background;
    program.set("u_background", glm::vec4(glm::dvec4(glm::dvec3(b) * b.a, b.a)));
}

void SliceEffect::draw(const Pass& pass) {
    GpuVolume& gpu =
        *load_gpu_volume(pass.assets(), pass.gl(), *sampled_, sampled_channel_, params_.volume.storage);
    gpu.update(*sampled_);
    if (!table_.is_of(parameters_key_, *source_)) {
        make_table(pass.gl(), gpu.map());
    }
    const auto variant = std::ranges::find(variants_, std::pair(space_.shape.kind, gpu.is_atlas()));
    const gl::Program& program = pass.use(static_cast<std::size_t>(variant - variants_.begin()));
    gpu.set(program);
    pass.bind(program, "u_volume", gpu.texture(), params_.sampling.texture_filter(function_.nearest),
              space_.shape.wrap && !gpu.is_atlas() ? gl::Wrap::repeat : gl::Wrap::clamp);
    set_places(program, space_);
    table_.bind(pass, program);
    set_plane(pass, program);
    if (!in_camera()) {
        pass.draw_fullscreen();
        return;
    }
    const gl::Mesh& mesh = *pass.assets().shared<gl::Mesh>(
        surface_key_, [&] { return std::make_shared<gl::Mesh>(pass.gl(), surface_); });
    const View& view = pass.frame().eye();
    program.set("u_to_clip", glm::mat4(view.view_projection() * space_.local_to_world));
    pass.raster(gl::depth_tested_state);
    mesh.draw();
}

}  // namespace viscera::volume
