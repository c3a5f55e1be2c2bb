#include "effects/volume/ray_cast_effect.h"

#include <algorithm>
#include <cmath>

#include "effects/volume/ray_frame.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::volume {
namespace {

constexpr int brick_size = 4;
constexpr int slab_limit = 30000;  // llvmpipe stops loops at 65,535 turns; skipping takes up to two a slab

RayFunction function_for(Technique technique) {
    switch (technique) {
        case Technique::mip:
            return RayFunction::mip;
        case Technique::minip:
            return RayFunction::minip;
        case Technique::average:
            return RayFunction::average;
        case Technique::xray:
            return RayFunction::xray;
        case Technique::isosurface:
        case Technique::composite:
            break;
    }
    return RayFunction::composite;
}

}  // namespace

void RayCastEffect::visit(ParamVisitor& visitor) {
    params_.visit(visitor);
}

void RayCastEffect::validate() const {
    if (params_.volume.file.empty() == params_.volume.host.empty()) {
        throw Error(ErrorCode::scene, "/volume", "needs either a file or a host's volume");
    }
    params_.transfer_function.validate();
}

std::vector<Port> RayCastEffect::ports() const {
    return {{.name = "colour",
             .access = Access::write,
             .target = "volume.colour",
             .doc = "Colour, premultiplied by opacity, and opacity.",
             .format = PixelFormat::rgba16f}};
}

std::span<const ProgramDesc> RayCastEffect::programs() const {
    programs_.clear();
    variants_.clear();
    // What a file's preset asks for is known when the file is read.
    const bool by_file = !params_.function && !params_.transfer_function.file.empty();
    const RayFunction given = params_.function.value_or(RayFunction::composite);
    for (const RayFunction function : {RayFunction::composite, RayFunction::mip, RayFunction::minip,
                                       RayFunction::average, RayFunction::xray}) {
        if (!by_file && function != given) {
            continue;
        }
        for (const bool skip : {false, true}) {
            ProgramDesc program{"common/fullscreen.vert", "volume/ray_cast.frag", {}};
            if (function == RayFunction::composite) {
                program.defines.emplace_back("COMPOSITE");
                program.defines.push_back("SCHEME " +
                                          std::to_string(static_cast<int>(params_.sampling.scheme)));
            } else {
                program.defines.push_back("PROJECTION " + std::to_string(static_cast<int>(function) - 1));
                if (params_.threshold) {
                    program.defines.emplace_back("THRESHOLD");
                }
            }
            if (params_.transfer_function.interpolate) {
                program.defines.emplace_back("TRANSFER_LINEAR");
            }
            if (skip) {
                program.defines.emplace_back("SKIP");
            }
            programs_.push_back(std::move(program));
            variants_.push_back({function, skip});
        }
    }
    // All of them again for what else may be in the picture, and as compute shaders.
    const auto again = [&](bool Variant::*what, std::string_view define) {
        const std::size_t count = programs_.size();
        for (std::size_t i = 0; i < count; ++i) {
            programs_.push_back(programs_[i]);
            variants_.push_back(variants_[i]);
            variants_.back().*what = true;
            if (what == &Variant::compute) {
                programs_.back() = {"", "", programs_[i].defines, "volume/ray_cast.comp"};
            } else {
                programs_.back().defines.emplace_back(define);
            }
        }
    };
    again(&Variant::surface, "SURFACE");
    again(&Variant::background, "BACKGROUND");
    again(&Variant::compute, "");
    return programs_;
}

void RayCastEffect::find_crop() {
    const glm::ivec3 dims = source_->volume().grid.dims;
    const glm::dvec3 n(dims);
    for (int a = 0; a < 3; ++a) {
        const double first = std::min(params_.crop.first[a], n[a]);
        const double last = params_.crop.size[a] > 0.0 ? std::min(first + params_.crop.size[a], n[a]) : n[a];
        box_min_[a] = first / n[a];
        box_max_[a] = last / n[a];
        crop_.first[a] = static_cast<int>(std::floor(first));
        crop_.size[a] = static_cast<int>(std::ceil(last)) - crop_.first[a];
    }
}

void RayCastEffect::find_function(Prepare& prepare) {
    function_ = load_function(params_.transfer_function, prepare.assets());
    variant_.function = params_.function.value_or(function_for(function_.technique));
}

void RayCastEffect::make_table(const gl::Functions& gl, const TexelMap& stored_of_texel) {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope * stored_of_texel.scale, volume.value_of(stored_of_texel.offset)};
    TexelRange range{map.texel_of(source_->statistics.min), map.texel_of(source_->statistics.max)};
    if (range.low > range.high) {
        std::swap(range.low, range.high);
    }
    const int entries = params_.transfer_function.entries;
    const ExtinctionKnots knots = extinction_knots(function_, map, range);
    ClassificationTable table = tabulate(knots, range, entries);
    if (projects()) {  // opacity as it is: extremes and means have no length
        for (int i = 0; i < entries; ++i) {
            table.entries[static_cast<std::size_t>(i)] =
                knots.evaluate(range.low + (range.high - range.low) * i / (entries - 1));
        }
    }
    table_.emplace(gl::Texture::make_2d(gl, entries, 1, PixelFormat::rgba32f, "transfer function"));
    table_->upload(std::as_bytes(std::span(table.entries)));
    table_place_ = table.place;
}

Work RayCastEffect::prepare(Prepare& prepare) {
    const bool changed = parameters_key_ != prepare.parameters_key();
    parameters_key_ = prepare.parameters_key();
    source_ = load_source(prepare.assets(), params_.volume, prepare.frame());
    if (!source_) {
        return Work::idle("the host gives no volume of this name");
    }
    const Volume& volume = source_->volume();
    if (changed) {
        find_function(prepare);
        find_crop();
        texture_to_world_ = placed(volume.grid, params_.volume.placement);
    }
    if (params_.transfer_function.empty() && variant_.function != RayFunction::xray) {
        return Work::idle("there is no transfer function");
    }
    if (!invertible(texture_to_world_)) {
        prepare.log().fault("volume.singular", "the volume's placement is singular; it is not drawn");
        return Work::idle("the volume's placement is singular");
    }
    const glm::dvec3 n(volume.grid.dims);
    double spacing = 1e300;
    double diagonal = 0.0;
    for (int a = 0; a < 3; ++a) {
        const double length = glm::length(glm::dvec3(texture_to_world_[a]));
        spacing = std::min(spacing, length / n[a]);
        diagonal += length;
    }
    const bool pairs = !projects() && params_.sampling.scheme == Scheme::gauss;
    slab_mm_ = params_.sampling.step * spacing * (pairs ? 2.0 : 1.0);
    if (slab_mm_ < diagonal / slab_limit) {
        prepare.log().fault("volume.step", "the step would take more than " + std::to_string(slab_limit) +
                                               " slabs through the volume; it is made longer");
        slab_mm_ = diagonal / slab_limit;
    }
    const double slab_voxels = params_.sampling.step * (pairs ? 2.0 : 1.0);
    const int border = static_cast<int>(std::ceil((pairs ? 0.289 * slab_voxels : 0.0) + 0.5));
    variant_.skip = params_.sampling.skip && !projects();
    if (variant_.skip) {
        bricks_ = load_bricks(prepare.assets(), *source_, params_.volume.channel, brick_size, border);
        const TexelMap map{volume.slope, volume.intercept};
        const double a = map.texel_of(source_->statistics.min);
        const double b = map.texel_of(source_->statistics.max);
        const std::vector<StoredRange> visible = stored_ranges(
            function_, map, {std::min(a, b), std::max(a, b)}, params_.transfer_function.entries);
        skip_map_.update(bricks_->grid, visible, crop_,
                         Hash().add(parameters_key_).add(bricks_.get()).add(bricks_->version).value());
        if (skip_map_.occupancy() == 0.0) {
            return Work::idle("the transfer function shows nothing of the volume");
        }
        variant_.skip = skip_map_.occupancy() < 0.98;
    }
    const View& view = prepare.frame().eye();
    const Bounds bounds{glm::vec3(box_min_), glm::vec3(box_max_)};
    const glm::ivec2 size = prepare.size("colour");
    const PixelRect region = project_bounds(bounds, view.view_projection() * texture_to_world_, size);
    if (region.empty()) {
        return Work::idle("the volume lies outside the view");
    }
    const std::uint64_t key = Hash()
                                  .add(parameters_key_)
                                  .add(source_->key)
                                  .add(source_->version())
                                  .add(view.view)
                                  .add(view.projection)
                                  .value();
    return region == PixelRect{0, 0, size.x, size.y}
               ? Work::all(key)
               : Work::in_region(region, "only where the volume can be seen", key);
}

void RayCastEffect::draw(const Pass& pass) {
    GpuVolume& gpu = *pass.assets().shared<GpuVolume>(
        Hash().add(source_->key).add(params_.volume.channel).value(),
        [&] { return std::make_shared<GpuVolume>(pass.gl(), *source_, params_.volume.channel); });
    gpu.update(*source_);
    const Volume& volume = source_->volume();
    const TexelMap& map = gpu.map();
    const auto texel = [&](double value) { return map.texel_of((value - volume.intercept) / volume.slope); };
    const std::uint64_t table_key = Hash().add(parameters_key_).add(source_->version()).value();
    if (table_key_ != table_key) {
        make_table(pass.gl(), map);
        table_key_ = table_key;
    }
    variant_.compute = pass.compute("colour");
    const auto variant = std::ranges::find(variants_, variant_);
    const gl::Program& program = pass.use(static_cast<std::size_t>(variant - variants_.begin()));
    const RayFrame frame = make_ray_frame(pass.frame().eye(), texture_to_world_);
    program.set("u_pixel", 2.0F / glm::vec2(pass.size()));
    program.set("u_point", std::span<const glm::vec3>(frame.point));
    program.set("u_direction", std::span<const glm::vec3>(frame.direction));
    program.set("u_world_direction", std::span<const glm::vec3>(frame.world_direction));
    program.set("u_near_far", frame.near_far);
    program.set("u_box_min", glm::vec3(box_min_));
    program.set("u_box_max", glm::vec3(box_max_));
    program.set("u_slab", static_cast<float>(slab_mm_));
    program.set("u_slab_limit", slab_limit);
    program.set("u_transfer_place", glm::vec2(table_place_));
    program.set("u_depth_limit", params_.sampling.termination > 0.0
                                     ? static_cast<float>(-std::log(params_.sampling.termination))
                                     : 3e38F);
    const double mu = params_.xray.water_attenuation_per_mm;
    const double value_scale = volume.slope * map.scale;
    const double value_offset = volume.value_of(map.offset);
    program.set("u_attenuation",
                glm::vec2(glm::dvec2(mu * value_scale / 1000.0, mu * (1.0 + value_offset / 1000.0))));
    program.set("u_intensity", glm::vec2(params_.xray.incident, params_.xray.negative ? 1.0 : 0.0));
    if (params_.threshold) {
        program.set("u_threshold", static_cast<float>(texel(*params_.threshold)));
    }
    pass.bind(program, "u_volume", gpu.texture());
    pass.bind(program, "u_transfer", *table_, gl::Filter::nearest);
    if (variant_.skip) {
        program.set("u_bricks_per_unit",
                    glm::vec3(glm::dvec3(volume.grid.dims) / static_cast<double>(brick_size)));
        pass.bind(program, "u_bricks", skip_map_.texture(pass.gl()), gl::Filter::nearest);
    }
    if (variant_.compute) {
        pass.dispatch(program, "colour");
    } else {
        pass.draw_fullscreen();
    }
}

}  // namespace viscera::volume
