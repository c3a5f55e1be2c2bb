#include <algorithm>
#include <cmath>

#include "effects/volume/colours.h"
#include "effects/volume/look.h"
#include "engine/core/hash.h"

// A frame's draw: what the look gives the programs, and the textures that it is made of.
namespace viscera::volume {
namespace {

constexpr int gradient_entries = 1024;
constexpr int overlay_entries = 1024;

/// Where a second volume lies in programs that show another: see glsl/volume/labels.glsl and overlay.glsl.
struct Placed {
    glm::dmat4 from_local{1.0};  ///< local -> texture coordinates of a box
    bool curved = false;         ///< instead: texture coordinates of the volume -> its own
    Space::SampleMap map{};
};
Placed placed_in(const Volume& other, const Space& space) {
    const VolumeGrid& grid = other.grid;
    Placed result;
    result.curved = grid.curvilinear();
    if (result.curved) {
        result.map = between(space.dims, grid.dims, grid.shape.wrap_axis());
    } else {
        result.from_local = glm::inverse(grid.texture_to_world()) * space.local_to_unplaced;
    }
    return result;
}

std::uint64_t key_of(const TransferFunction& function) {
    Hash hash;
    for (const TransferPoint& point : function.points) {
        hash.add(point.value).add(point.colour).add(point.opacity);
    }
    for (const GradientPoint& point : function.gradient) {
        hash.add(point.gradient).add(point.factor);
    }
    return hash.add(function.reference_length_mm).value();
}

/// The unit box around a curvilinear volume in its frame -> world, with the placement.
glm::dmat4 box_to_world(const LookScene& scene) {
    return scene.space.local_to_world * glm::inverse(scene.space.local_to_unplaced) *
           scene.source.volume().grid.box_to_world();
}

/// Linear between knots, constant beyond them; the second knot of a step holds at the step.
double gradient_factor(const std::vector<GradientPoint>& points, double gradient) {
    const auto right = std::ranges::upper_bound(points, gradient, {}, &GradientPoint::gradient);
    if (right == points.begin() || right == points.end()) {
        return right == points.end() ? points.back().factor : right->factor;
    }
    const GradientPoint& left = *std::prev(right);
    return std::lerp(left.factor, right->factor,
                     (gradient - left.gradient) / (right->gradient - left.gradient));
}

template <class T>
gl::Texture table(const gl::Functions& gl, std::span<const T> texels, int rows, PixelFormat format,
                  std::string_view label) {
    gl::Texture texture =
        gl::Texture::make_2d(gl, static_cast<int>(texels.size()) / rows, rows, format, label);
    texture.upload(std::as_bytes(texels));
    return texture;
}

Storage storage_of(const LookScene& scene) {
    return scene.atlas ? Storage::atlas : Storage::texture_3d;
}

}  // namespace

void Look::bind_labels(const LookParams& params, const LookScene& scene, const Pass& pass,
                       const gl::Program& program) {
    const Volume& labels = labels_->volume();
    const glm::ivec3 n = labels.grid.dims;
    Hash ids;
    for (const Segment& segment : params.labels.segments) {
        ids.add(segment.id);
    }
    label_voxels_ = pass.assets().shared<Made>(
        Hash().add("label voxels").add(labels_->key).add(ids.value()).add(scene.atlas).value(),
        [] { return std::make_shared<Made>(); });
    const std::uint64_t voxels_key = labels_->state_key();
    if (label_voxels_->key != voxels_key) {
        std::size_t broken = 0;
        const std::vector<std::uint16_t> dense = dense_labels(labels, params.labels, broken);
        if (broken > 0) {
            pass.log().fault("volume.labels", "labels are not whole numbers; they count as not listed",
                             broken);
        }
        label_voxels_->atlas =
            choose_storage(n, storage_of(scene), TextureLimits::query(pass.gl()), labels.source);
        label_voxels_->texture.emplace(label_texture(pass.gl(), labels, dense, label_voxels_->atlas));
        label_voxels_->key = voxels_key;
    }
    if (label_looks_.key != parameters_key_) {
        const std::vector<glm::vec4> looks = look_table(params.labels);
        label_looks_.texture = table<glm::vec4>(pass.gl(), looks, 2, PixelFormat::rgba32f, "looks of labels");
        label_looks_.key = parameters_key_;
    }
    // Labels follow the volume's placement: both lie in one unplaced world.
    const Placed place = placed_in(labels, scene.space);
    glm::dmat4 to_voxels(1.0);
    for (int a = 0; a < 3; ++a) {
        to_voxels[a][a] = n[a];
    }
    program.set("u_labels_from_local", glm::mat4(to_voxels * place.from_local));
    program.set("u_labels_curved", place.curved);
    program.set("u_labels_scale", glm::vec3(place.map.scale * glm::dvec3(n)));
    program.set("u_labels_offset", glm::vec3(place.map.offset * glm::dvec3(n)));
    if (label_voxels_->atlas) {
        program.set("u_labels_size", label_voxels_->atlas->dims);
        program.set("u_labels_tiles", label_voxels_->atlas->tiles);
    }
    pass.bind(program, "u_labels", *label_voxels_->texture, gl::Filter::nearest);
    pass.bind(program, "u_label_looks", *label_looks_.texture, gl::Filter::nearest);
}

void Look::bind_ramps(const LookParams& params, const LookScene& scene, const Pass& pass,
                      const gl::Program& program) {
    const std::uint64_t ramps_key =
        Hash().add(parameters_key_).add(scene.source.state_key()).add(key_of(scene.function)).value();
    if (label_ramps_.key != ramps_key) {
        std::vector<TransferFunction> rows = ramps(params.labels, scene.function);
        rows.insert(rows.begin(), scene.function);
        std::vector<glm::vec4> texels;
        for (const TransferFunction& row : rows) {
            const ClassificationTable entries = tabulate(
                extinction_knots(row, scene.value_of_texel, scene.range), scene.range, scene.entries);
            texels.insert(texels.end(), entries.entries.begin(), entries.entries.end());
        }
        label_ramps_.texture = table<glm::vec4>(pass.gl(), texels, static_cast<int>(rows.size()),
                                                PixelFormat::rgba32f, "ramps of labels");
        label_ramps_.key = ramps_key;
    }
    pass.bind(program, "u_label_ramps", *label_ramps_.texture, gl::Filter::nearest);
}

void Look::bind_overlay(const LookParams& params, const LookScene& scene, const Pass& pass,
                        const gl::Program& program) {
    const Volume& overlay = overlay_->volume();
    GpuVolume& gpu = *load_gpu_volume(pass.assets(), pass.gl(), *overlay_, 0, storage_of(scene));
    gpu.update(*overlay_);
    gpu.set(program, "u_overlay_size", "u_overlay_tiles");
    const std::uint64_t map_key = Hash().add(overlay_->state_key()).add(parameters_key_).value();
    if (overlay_map_.key != map_key) {
        const OverlayTable map = overlay_table(
            overlay_map(params.overlay, overlay_->statistics.min, overlay_->statistics.max), overlay_entries);
        overlay_map_.texture =
            table<glm::vec4>(pass.gl(), map.entries, 1, PixelFormat::rgba32f, "colours of the overlay");
        const double scale = overlay.slope * gpu.map().scale;
        overlay_place_ = {map.place.x * scale,
                          map.place.x * overlay.value_of(gpu.map().offset) + map.place.y};
        overlay_map_.key = map_key;
    }
    const Placed place = placed_in(overlay, scene.space);
    program.set("u_overlay_from_local", glm::mat4(place.from_local));
    program.set("u_overlay_curved", place.curved);
    program.set("u_overlay_scale", glm::vec3(place.map.scale));
    program.set("u_overlay_offset", glm::vec3(place.map.offset));
    program.set("u_overlay_place", glm::vec2(overlay_place_));
    program.set("u_overlay_strength", static_cast<float>(params.overlay.strength));
    pass.bind(program, "u_overlay", gpu.texture(), gl::Filter::linear,
              overlay.grid.shape.wrap && !gpu.is_atlas() ? gl::Wrap::repeat : gl::Wrap::clamp);
    pass.bind(program, "u_overlay_map", *overlay_map_.texture, gl::Filter::nearest);
}

void Look::bind_gradient(const LookScene& scene, const Pass& pass, const gl::Program& program) {
    const std::vector<GradientPoint>& points = scene.function.gradient;
    const double last = std::max(points.back().gradient, 1e-30);
    const std::uint64_t key = key_of(scene.function);
    if (gradient_factor_.key != key) {
        std::vector<float> factors;
        for (int i = 0; i < gradient_entries; ++i) {
            factors.push_back(static_cast<float>(gradient_factor(points, last * i / (gradient_entries - 1))));
        }
        gradient_factor_.texture =
            table<float>(pass.gl(), factors, 1, PixelFormat::r32f, "opacity over gradient");
        gradient_factor_.key = key;
    }
    const double length = scene.function.reference_length_mm;
    program.set("u_gradient_place",
                glm::vec3(glm::dvec3(std::abs(scene.value_of_texel.scale) * (gradient_entries - 1) / last,
                                     length, 1.0 / length)));
    pass.bind(program, "u_gradient_factor", *gradient_factor_.texture, gl::Filter::nearest);
}

/// What of light a voxel takes, as it is seen: in its segment's look.
VoxelExtinction Look::extinction_of(const LookParams& params, const LookScene& scene) const {
    const Volume& volume = scene.source.volume();
    const auto of_function = [](const TransferFunction& function) {
        return [function](double value) {
            return extinction(evaluate(function, value).w, function.reference_length_mm);
        };
    };
    const auto of_voxels = [&](const TransferFunction& function) {
        return scene.colours != nullptr
                   ? colour_extinction(*scene.colours, *scene.accumulate, volume.grid.diagonal_mm())
                   : of_values(volume, scene.channel, of_function(function));
    };
    if (!params.labels.used()) {
        return of_voxels(scene.function);
    }
    std::vector<VoxelExtinction> rows{of_voxels(scene.function)};
    for (const TransferFunction& ramp : ramps(params.labels, scene.function)) {
        rows.push_back(of_voxels(ramp));
    }
    return [rows = std::move(rows), looks = look_table(params.labels),
            label_at = labels_at(labels_->volume(), params.labels, volume.grid)](const glm::ivec3& voxel) {
        const glm::vec4& how = looks[looks.size() / 2 + label_at(voxel)];
        return how.x > 0.0F ? static_cast<double>(how.x) * rows[static_cast<std::size_t>(how.y)](voxel) : 0.0;
    };
}

void Look::bind_light(const LookParams& params, const LookScene& scene, const Pass& pass,
                      const gl::Program& program) {
    const LightVolumeParams& how = params.shading.light_volume;
    const bool curved = scene.space.shape.curvilinear();
    const glm::dvec4 light = params.shading.lights.empty()
                                 ? glm::dvec4(0.0, 0.0, 1.0, 0.0)
                                 : params.shading.lights.front().place(pass.frame().eye());
    const std::uint64_t alike = Hash()
                                    .add("light volume")
                                    .add(scene.channel)
                                    .add(key_of(scene.function))
                                    .add(scene.source.key)
                                    .add(scene.space.local_to_world)
                                    .add(how.shadow)
                                    .add(how.ambient_occlusion)
                                    .add(how.resolution)
                                    .add(how.radius_mm)
                                    .add(how.shadow > 0.0 ? light : glm::dvec4(0.0))
                                    .add(labels_ || scene.colours != nullptr ? parameters_key_ : 0)
                                    .value();
    light_ = pass.assets().shared<Made>(alike, [] { return std::make_shared<Made>(); });
    const std::uint64_t key =
        Hash().add(scene.source.state_key()).add(labels_ ? labels_->state_key() : 0).value();
    if (light_->key != key) {
        const VolumeGrid& voxels = scene.source.volume().grid;
        const VoxelExtinction of_voxel = extinction_of(params, scene);
        const ExtinctionGrid grid =
            curved ? extinction_in_box(voxels, box_to_world(scene), how.resolution, of_voxel)
                   : extinction_grid(voxels.dims, scene.space.local_to_world, how.resolution, of_voxel);
        light_->texture.emplace(gl::Texture::make_3d(pass.gl(), {grid.dims.x, grid.dims.y, grid.dims.z},
                                                     gl::texture_format(PixelFormat::rg32f), "light volume"));
        const std::vector<glm::vec2> texels = light_volume(grid, how, light);
        light_->texture->upload(std::as_bytes(std::span(texels)));
        light_->key = key;
    }
    program.set(
        "u_light_volume_from_local",
        curved ? glm::mat4(glm::inverse(box_to_world(scene)) * scene.space.local_to_world) : glm::mat4(1.0F));
    pass.bind(program, "u_light_volume", *light_->texture, gl::Filter::linear);
}

void Look::bind(const LookParams& params, const Variant& variant, const LookScene& scene, const Pass& pass,
                const gl::Program& program) {
    if (variant.shaded) {
        params.shading.set(program, scene.function, pass.frame().eye(), scene.space.local_to_world,
                           scene.value_of_texel.scale > 0.0);
    }
    if (variant.shaded || variant.by_gradient) {
        program.set("u_metric",
                    glm::mat3(glm::transpose(glm::inverse(glm::dmat3(scene.space.local_to_world)))));
    }
    if (variant.by_gradient) {
        bind_gradient(scene, pass, program);
    }
    if (params.labels.used()) {
        bind_labels(params, scene, pass, program);
    }
    if (!variant.composed) {
        return;
    }
    if (params.labels.has_ramps()) {
        bind_ramps(params, scene, pass, program);
    }
    if (params.overlay.used()) {
        bind_overlay(params, scene, pass, program);
    }
    if (params.shading.light_volume.used()) {
        bind_light(params, scene, pass, program);
    }
}

}  // namespace viscera::volume
