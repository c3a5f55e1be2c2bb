#include "effects/volume/ray_cast_effect.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "effects/volume/colours.h"
#include "effects/volume/crop.h"
#include "effects/volume/gradients.h"
#include "effects/volume/prefilter.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::volume {
namespace {

constexpr int blue_noise_size = 32;
constexpr int most_integrated_ramps = 255;

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
            return RayFunction::isosurface;
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
    params_.volume.validate();
    params_.transfer_function.validate();
    if (params_.sampling.scheme == Scheme::preintegrated &&
        params_.look.labels.ramp_count() > most_integrated_ramps) {
        throw Error(ErrorCode::scene, "/labels/segments",
                    "preintegrated takes at most " + std::to_string(most_integrated_ramps) +
                        " segments with transfer functions of their own");
    }
    if (params_.isosurface.values.size() > most_iso_values) {
        throw Error(ErrorCode::scene, "/isosurface/values",
                    "at most " + std::to_string(most_iso_values) + " surfaces");
    }
    params_.look.validate();
    params_.accumulate.validate();
    check_colours();
    const ReconstructionParams& filter = params_.sampling.reconstruction;
    if (filter.keeps_gradients() &&
        (filter.is_tricubic() || filter.filter == ReconstructionFilter::nearest)) {
        throw Error(ErrorCode::scene, "/sampling/gradient",
                    "precomputed gradients are those of the linear filters");
    }
    if (params_.sampling.fovea) {
        params_.sampling.fovea->validate();
    }
    if (params_.volume.geometry && params_.volume.geometry->kind != VolumeKind::cartesian) {
        check_kind();
    }
}

/// Throws Error(scene) for what only boxes can have.
void RayCastEffect::check_kind() const {
    if (params_.sampling.scheme == Scheme::cell) {
        throw Error(
            ErrorCode::scene, "/sampling/scheme",
            "cell goes from face to face of straight cells; those of a curvilinear volume are curved");
    }
}

/// Throws Error(scene) for what takes a value and not a colour.
void RayCastEffect::check_colours() const {
    if (!shows_colours()) {
        return;
    }
    const auto refuse = [](bool asked, const char* key, const char* what) {
        if (asked) {
            throw Error(ErrorCode::scene, key,
                        std::string(what) + " a value; accumulate.channels takes colours as they are");
        }
    };
    refuse(params_.sampling.scheme == Scheme::preintegrated, "/sampling/scheme",
           "preintegrated integrates a transfer function over");
    refuse(params_.look.labels.used() && params_.look.labels.has_ramps(), "/labels",
           "transfer functions of segments take");
}

/// With an atlas they are made on the fly: nothing else is as large as what needs one.
bool RayCastEffect::needs_kept_gradients() const {
    return params_.sampling.reconstruction.keeps_gradients() && params_.volume.storage != Storage::atlas &&
           (variant_.function == RayFunction::isosurface || variant_.look.shaded ||
            variant_.look.by_gradient);
}

void RayCastEffect::bind_gradients(const Pass& pass, const gl::Program& program, const TexelMap& map) const {
    GpuVolume& gpu =
        *load_gpu_volume(pass.assets(), pass.gl(), *gradients_, all_channels, Storage::texture_3d);
    gpu.update(*gradients_);
    const Volume& volume = gradients_->volume();
    // Infinite times nothing would be no number; of what is so steep only the direction counts.
    constexpr double steepest = 1e30;
    const double scale = 32767.0 * volume.slope / map.scale;
    program.set("u_gradient_scale", glm::vec3(std::min(scale, steepest) * glm::dvec3(volume.grid.dims)));
    pass.bind(program, "u_gradients", gpu.texture(), gl::Filter::linear,
              space_.shape.wrap ? gl::Wrap::repeat : gl::Wrap::clamp);
}

void RayCastEffect::set_colours(const gl::Program& program, double share_per_texel) const {
    const AccumulateParams& how = params_.accumulate;
    const ColourLimits limits = colour_limits(how);
    program.set("u_colour_scale", static_cast<float>(share_per_texel));
    program.set("u_colour_low", glm::vec4(limits.low));
    program.set("u_colour_high", glm::vec4(limits.high));
    program.set(
        "u_colour_opacity",
        glm::vec2(glm::dvec2(how.opacity / how.samples, how.samples / source_->volume().grid.diagonal_mm())));
    program.set("u_colour_contrast", glm::vec2(glm::dvec2(how.brightness, how.contrast)));
}

std::vector<Port> RayCastEffect::ports() const {
    std::vector<Port> ports{{.name = "colour",
                             .access = Access::write,
                             .target = "volume.colour",
                             .doc = "Colour, premultiplied by opacity, and opacity.",
                             .format = PixelFormat::rgba16f,
                             .passthrough = "background"},
                            {.name = "depth",
                             .target = "mesh.depth",
                             .doc = "Depth of opaque surfaces, drawn with the same camera: rays end there.",
                             .optional = true},
                            {.name = "background",
                             .target = "mesh.colour",
                             .doc = "Picture behind, premultiplied by its opacity: the volume goes over it.",
                             .optional = true}};
    if (is_coarse()) {
        ports.pop_back();  // what is behind comes in full resolution
        ports.front().target = "volume.coarse";
        ports.front().size.scale = 0.5;
        ports.front().passthrough.clear();
    } else if (params_.mixed) {
        ports.push_back({.name = "coarse",
                         .target = "volume.coarse",
                         .doc = "Picture of a coarse pass that has the same parameters.",
                         .optional = true});
    }
    if (params_.sampling.limits != Limits::analytic) {
        ports.push_back({.name = "entry", .target = "volume.entry", .doc = "Where rays enter."});
        ports.push_back({.name = "exit", .target = "volume.exit", .doc = "Where rays leave."});
    }
    if (params_.sampling.limits == Limits::mesh) {
        ports.push_back({.name = "inner_entry",
                         .target = "volume.inner_entry",
                         .doc = "Where rays enter for the last time, for meshes that they may pass twice.",
                         .optional = true});
        ports.push_back({.name = "inner_exit",
                         .target = "volume.inner_exit",
                         .doc = "Where rays leave for the first time.",
                         .optional = true});
    }
    return ports;
}

void RayCastEffect::find_crop() {
    const CropBox box = crop_box(params_.crop, source_->volume().grid.dims);
    box_min_ = box.low;
    box_max_ = box.high;
    crop_ = box.voxels;
}

void RayCastEffect::find_function(Prepare& prepare) {
    function_ = load_function(params_.transfer_function, prepare.assets());
    const RayFunction wanted = params_.function.value_or(function_for(function_.technique));
    variant_.function = marched_as(wanted);
    std::size_t faults = 0;
    if (wanted == RayFunction::density) {
        function_ = normalised(density_function(function_, params_.density), faults);
    } else if (wanted == RayFunction::accumulate) {
        function_ =
            normalised(accumulate_function(params_.accumulate, source_->statistics.min,
                                           source_->statistics.max, source_->volume().grid.diagonal_mm()),
                       faults);
    }
    variant_.look = projects() ? Look::Variant{} : Look::variant(params_.look, function_);
}

/// Texels between the least and the greatest value, as floats: a knot at an end then lies on the table's
/// first or last entry, not beside it by its rounding.
TexelRange RayCastEffect::texel_range(const TexelMap& stored_of_texel) const {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope * stored_of_texel.scale, volume.value_of(stored_of_texel.offset)};
    const auto texel = [&](double value) {
        return static_cast<double>(static_cast<float>(map.texel_of(value)));
    };
    const double a = texel(source_->statistics.min);
    const double b = texel(source_->statistics.max);
    return {std::min(a, b), std::max(a, b)};
}

ExtinctionKnots RayCastEffect::knots_of_texel(const TransferFunction& function,
                                              const TexelMap& stored_of_texel) const {
    const Volume& volume = source_->volume();
    const TexelMap map{volume.slope * stored_of_texel.scale, volume.value_of(stored_of_texel.offset)};
    return extinction_knots(function, map, texel_range(stored_of_texel));
}

/// What the shader looks values up in.
ClassificationTable RayCastEffect::table_of_texel(const TexelMap& stored_of_texel) const {
    const TexelRange range = texel_range(stored_of_texel);
    const int entries = params_.transfer_function.entries;
    const ExtinctionKnots knots = knots_of_texel(function_, stored_of_texel);
    ClassificationTable table = tabulate(knots, range, entries);
    if (projects()) {  // opacity as it is: extremes and means have no length
        for (int i = 0; i < entries; ++i) {
            table.entries[static_cast<std::size_t>(i)] =
                knots.evaluate(range.low + (range.high - range.low) * i / (entries - 1));
        }
    }
    return table;
}

void RayCastEffect::make_table(const gl::Functions& gl, const TexelMap& stored_of_texel) {
    const ClassificationTable table = table_of_texel(stored_of_texel);
    table_.emplace(gl::Texture::from_row(gl, std::as_bytes(std::span(table.entries)),
                                         gl::texture_format(PixelFormat::rgba32f), "transfer function"));
    table_place_ = table.place;
    table_seen_ = static_cast<float>(table.first_seen()) - 1.0F;
    if (params_.sampling.scheme == Scheme::preintegrated && !projects()) {
        make_slabs(gl, stored_of_texel);
    }
}

/// The transfer function's and those of segments, in the order of the rows that labels name.
void RayCastEffect::make_slabs(const gl::Functions& gl, const TexelMap& stored_of_texel) {
    std::vector<TransferFunction> functions = ramps(params_.look.labels, function_);
    functions.insert(functions.begin(), function_);
    constexpr std::size_t most_pieces = 131072;  // of all together: 12 MiB
    const auto pieces =
        static_cast<int>(std::min<std::size_t>(most_pieces / functions.size(), most_slab_pieces));
    std::vector<SlabTable> tables;
    for (const TransferFunction& function : functions) {
        tables.push_back(tabulate_slabs(knots_of_texel(function, stored_of_texel),
                                        texel_range(stored_of_texel), slab_bins, pieces));
    }
    slabs_.emplace(gl, tables);
}

Work RayCastEffect::prepare(Prepare& prepare) {
    source_ = load_source(prepare.assets(), params_.volume, prepare.frame());
    if (!source_) {
        return Work::idle("the host gives no volume of this name");
    }
    // A host may put a volume of another grid in its place.
    const bool changed = parameters_key_ != prepare.parameters_key() || source_version_ != source_->version();
    const bool coefficients = params_.sampling.reconstruction.uses_coefficients();
    sampled_channel_ = coefficients ? 0 : params_.volume.channel;
    voxels_ = source_;
    int channel = params_.volume.channel;
    if (shows_colours()) {
        voxels_ =
            load_colours(prepare.assets(), *source_, static_cast<int>(params_.accumulate.channels.size()));
        channel = sampled_channel_ = all_channels;
    }
    sampled_ = coefficients ? load_coefficients(prepare.assets(), *voxels_, channel) : voxels_;
    const Volume& volume = source_->volume();
    if (changed) {
        find_function(prepare);
        find_crop();
        space_ = make_space(volume.grid, params_.volume.placement);
        source_version_ = source_->version();
        parameters_key_ = prepare.parameters_key();  // only now: any of the above may fail or be cancelled
    }
    if (params_.transfer_function.empty() && variant_.function != RayFunction::xray &&
        params_.function != RayFunction::accumulate && variant_.function != RayFunction::isosurface) {
        return Work::idle("there is no transfer function");
    }
    if (variant_.function == RayFunction::isosurface && params_.isosurface.values.empty()) {
        return Work::idle("there is no iso value");
    }
    variant_.kind = space_.shape.kind;
    if (space_.shape.curvilinear()) {
        check_kind();
        if (space_.shape.flat()) {
            prepare.log().fault("volume.flat", volume.source + ": an extent is 0; it is not drawn");
            return Work::idle("the volume encloses nothing");
        }
    }
    if (!invertible(space_.local_to_world)) {
        prepare.log().fault("volume.singular", "the volume's placement is singular; it is not drawn");
        return Work::idle("the volume's placement is singular");
    }
    if (const std::string_view missing = look_.load(params_.look, volume.grid, prepare); !missing.empty()) {
        return Work::idle(missing);
    }
    if (space_.shape.curvilinear() && glm::any(glm::greaterThanEqual(box_min_, box_max_))) {
        return Work::idle("the crop leaves nothing");
    }
    constexpr int opacity = 3;  // of colours, of which shading takes the gradient
    gradients_ = needs_kept_gradients() ? load_gradients(prepare.assets(), *voxels_,
                                                         shows_colours() ? opacity : params_.volume.channel)
                                        : nullptr;
    const FrameBox cropped = space_.box_of(box_min_, box_max_);
    const ClippedBox box =
        clipped_box(cropped.min, cropped.max, space_.local_to_world, params_.look.clip_planes);
    if (box.empty()) {
        return Work::idle("everything is clipped");
    }
    lattice_ = make_lattice(params_.sampling, space_, prepare.log(), prepare.frame().quality.step_factor);
    if (!find_bricks(prepare)) {
        return Work::idle("nothing of the volume is to be seen");
    }
    const View& view = prepare.frame().eye();
    const Bounds bounds = seen_bounds({glm::vec3(box.min), glm::vec3(box.max)});
    const glm::ivec2 size = prepare.size("colour");
    variant_.surface = prepare.has("depth");
    depth_size_ = prepare.size("depth");
    variant_.background = prepare.has("background");
    variant_.inner =
        params_.sampling.limits == Limits::mesh && prepare.has("inner_entry") && prepare.has("inner_exit");
    variant_.fills = params_.mixed && prepare.has("coarse") &&
                     can_fill(prepare.size("coarse"), lattice_of(prepare.frame(), depth_size_), size);
    if (params_.sampling.limits != Limits::analytic && !prepare.has("exit")) {
        return Work::idle("what limits the rays is not in the view");
    }
    const PixelRect region = project_bounds(bounds, view.view_projection() * space_.local_to_world, size);
    if (region.empty()) {
        return Work::idle("the volume lies outside the view");
    }
    fovea_centre_ =
        params_.sampling.fovea ? params_.sampling.fovea->centre_of(prepare.frame()) : glm::dvec2(0.0);
    const std::uint64_t key = Hash()
                                  .add(parameters_key_)
                                  .add(source_->key)
                                  .add(source_->version())
                                  .add(lattice_.slab_mm)
                                  .add(fovea_centre_)
                                  .add(look_.key())
                                  .add(view.view)
                                  .add(view.projection)
                                  .value();
    return variant_.background || region == PixelRect{0, 0, size.x, size.y}
               ? Work::all(key)
               : Work::in_region(region, "only where the volume can be seen", key);
}

void RayCastEffect::bind_blue_noise(const Pass& pass, const gl::Program& program) {
    if (!blue_noise_) {
        blue_noise_ = pass.assets().shared<gl::Texture>(Hash().add("blue noise").value(), [&] {
            const std::vector<std::uint16_t> ranks = blue_noise(blue_noise_size, 1);
            std::vector<float> values(ranks.size());
            std::ranges::transform(ranks, values.begin(), [&](std::uint16_t rank) {
                return (static_cast<float>(rank) + 0.5F) / static_cast<float>(ranks.size());
            });
            auto texture = std::make_shared<gl::Texture>(gl::Texture::make_2d(
                pass.gl(), blue_noise_size, blue_noise_size, PixelFormat::r32f, "blue noise"));
            texture->upload(std::as_bytes(std::span(values)));
            return texture;
        });
    }
    pass.bind(program, "u_blue_noise", *blue_noise_, gl::Filter::nearest, gl::Wrap::repeat);
    const int seed = params_.sampling.seed;
    program.set("u_blue_noise_shift",
                glm::ivec2((seed * 13) % blue_noise_size, (seed * 7) % blue_noise_size));
}

void RayCastEffect::draw(const Pass& pass) {
    // One program for each way to store: a volume that does not fit takes the others with it.
    const bool large = params_.volume.storage == Storage::automatic && !look_.fits_3d(pass.gl());
    GpuVolume& gpu = *load_gpu_volume(pass.assets(), pass.gl(), *sampled_, sampled_channel_,
                                      large ? Storage::atlas : params_.volume.storage);
    gpu.update(*sampled_);
    variant_.atlas = gpu.is_atlas();
    const Volume& volume = source_->volume();
    const TexelMap& map = gpu.map();
    const auto texel = [&](double value) { return map.texel_of((value - volume.intercept) / volume.slope); };
    const std::uint64_t table_key = Hash().add(parameters_key_).add(source_->version()).value();
    if (table_key_ != table_key) {
        make_table(pass.gl(), map);
        table_key_ = table_key;
    }
    variant_.compute = pass.compute("colour");
    const RayFrame frame = make_ray_frame(pass.frame().eye(), space_.local_to_world, space_.low, space_.high);
    if (variant_.fills) {
        fill_in(pass, frame);
    }
    const auto variant = std::ranges::find(variants_, variant_);
    const gl::Program& program = pass.use(static_cast<std::size_t>(variant - variants_.begin()));
    set_picture(pass, frame, program);
    if (variant_.fills) {
        pass.bind(program, "u_plan", plan_.tiles(), gl::Filter::nearest);
    }
    if (params_.sampling.fovea) {
        params_.sampling.fovea->set(program, fovea_centre_,
                                    is_coarse() ? lattice_of(pass.frame(), depth_size_) : pass.size());
    }
    set_coordinates(program, space_, box_min_, box_max_);
    program.set("u_slab", static_cast<float>(lattice_.slab_mm));
    program.set("u_slab_limit", lattice_.slab_limit);
    program.set("u_voxels", glm::vec3(volume.grid.dims));
    if (params_.sampling.jitter == Jitter::blue_noise) {
        bind_blue_noise(pass, program);
    }
    program.set("u_seed", static_cast<unsigned>(params_.sampling.seed));
    if (variant_.function == RayFunction::isosurface) {
        volume::bind(params_.isosurface, TexelMap{volume.slope * map.scale, volume.value_of(map.offset)},
                     params_.sampling.termination, program);
    }
    program.set("u_transfer_seen", table_seen_);
    program.set("u_transfer_place", glm::vec3(table_place_, table_->width() - 1));
    if (slabs_) {
        slabs_->bind(pass, program);
    }
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
    gpu.set(program);
    pass.bind(program, "u_volume", gpu.texture(),
              params_.sampling.reconstruction.texture_filter(function_.nearest),
              space_.shape.wrap && !gpu.is_atlas() ? gl::Wrap::repeat : gl::Wrap::clamp);
    pass.bind(program, "u_transfer", *table_, gl::Filter::nearest);
    if (params_.sub_volume) {
        program.set("u_sub_volume_depth", static_cast<float>(params_.sub_volume->depth_mm));
    }
    if (!params_.look.clip_planes.empty()) {
        set_clips(program, params_.look.clip_planes, space_.local_to_world);
    }
    if (shows_colours()) {
        set_colours(program, sampled_->volume().slope * map.scale);
    }
    if (gradients_ && !variant_.atlas) {
        bind_gradients(pass, program, map);
    }
    if (!projects()) {
        LookScene scene{*source_,
                        params_.volume.channel,
                        function_,
                        space_,
                        TexelMap{value_scale, value_offset},
                        texel_range(map),
                        params_.transfer_function.entries};
        scene.atlas = variant_.atlas;
        if (shows_colours()) {
            scene.value_of_texel = {};
            scene.colours = &voxels_->volume();
            scene.accumulate = &params_.accumulate;
        }
        look_.bind(params_.look, variant_.look, scene, pass, program);
    }
    if (variant_.skipping != Skipping::none) {
        const VoxelBox& occupied = skip_map_.occupied_box();
        program.set("u_occupied_low", glm::vec3(occupied.first));
        program.set("u_occupied_high", glm::vec3(occupied.first + occupied.size));
        program.set("u_bricks_per_unit",
                    glm::vec3(glm::dvec3(volume.grid.dims) / static_cast<double>(brick_size)));
        pass.bind(program, "u_bricks", skip_map_.texture(pass.gl()), gl::Filter::nearest);
    }
    if (params_.sampling.limits != Limits::analytic) {
        pass.bind(program, "u_entry", "entry");
        pass.bind(program, "u_exit", "exit");
    }
    if (variant_.inner) {
        pass.bind(program, "u_inner_entry", "inner_entry");
        pass.bind(program, "u_inner_exit", "inner_exit");
    }
    if (variant_.fills && !variant_.compute) {
        plan_.draw_tiles(pass);
    } else {
        cover(pass, program);
    }
}

}  // namespace viscera::volume
