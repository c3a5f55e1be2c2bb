#include <algorithm>
#include <cassert>
#include <cmath>

#include "effects/volume/colours.h"
#include "effects/volume/gradients.h"
#include "effects/volume/ray_cast_effect.h"
#include "engine/core/hash.h"
#include "engine/runtime/pass.h"

// A frame's draw: what the programs are given.
namespace viscera::volume {
namespace {

constexpr int blue_noise_size = 32;

}  // namespace

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
    if (!table_.is_of(parameters_key_, *source_)) {
        make_table(pass.gl(), map);
    }
    variant_.compute = pass.compute("colour");
    const RayFrame frame = make_ray_frame(pass.frame().eye(), space_.local_to_world, space_.low, space_.high);
    if (variant_.fills) {
        fill_in(pass, frame);
    }
    const auto variant = std::ranges::find(variants_, variant_);
    assert(variant != variants_.end());
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
    table_.bind(pass, program);
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
    const std::optional<FilmParams>& film = params_.xray.film;
    program.set("u_film",
                film ? glm::vec2(glm::dvec2(film->from, 1.0 / (film->to - film->from))) : glm::vec2(0.0F));
    program.set("u_intensity", glm::vec2(params_.xray.incident, params_.xray.negative ? 1.0 : 0.0));
    if (params_.threshold) {
        program.set("u_threshold", static_cast<float>(texel(*params_.threshold)));
    }
    gpu.set(program);
    pass.bind(program, "u_volume", gpu.texture(),
              params_.sampling.reconstruction.texture_filter(function_.nearest),
              space_.shape.wrap && !gpu.is_atlas() ? gl::Wrap::repeat : gl::Wrap::clamp);
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
    if (variant_.skipping != Skipping::none) {
        const VoxelBox& occupied = skip_map_.occupied_box();
        program.set("u_occupied_low", glm::vec3(occupied.first));
        program.set("u_occupied_high", glm::vec3(occupied.first + occupied.size));
        program.set("u_bricks_per_unit",
                    glm::vec3(glm::dvec3(volume.grid.dims) / static_cast<double>(brick_size_)));
        pass.bind(program, "u_bricks", skip_map_.texture(pass.gl(), ways_of(frame)), gl::Filter::nearest);
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
