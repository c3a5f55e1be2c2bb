#include "effects/volume/ray_cast_effect.h"

#include "effects/volume/colours.h"
#include "effects/volume/crop.h"
#include "effects/volume/gradients.h"
#include "effects/volume/prefilter.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/region.h"

namespace viscera::volume {
namespace {

constexpr int most_integrated_ramps = 255;

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
    params_.xray.validate();
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
    refuse(params_.look.labels.has_ramps(), "/labels", "transfer functions of segments take");
    refuse(!params_.transfer_function.gradient.empty(), "/transfer_function/gradient",
           "opacity by gradient is by that of");
}

/// With an atlas they are made on the fly: nothing else is as large as what needs one.
bool RayCastEffect::needs_kept_gradients() const {
    return params_.sampling.reconstruction.keeps_gradients() && params_.volume.storage != Storage::atlas &&
           (variant_.function == RayFunction::isosurface || variant_.look.shaded ||
            variant_.look.by_gradient);
}

std::vector<Port> RayCastEffect::ports() const {
    std::vector<Port> ports{{.name = "colour",
                             .access = Access::write,
                             .target = "volume.colour",
                             .doc = "Colour, premultiplied by opacity, and opacity.",
                             .format = PixelFormat::rgba16f,
                             .passthrough = "background",
                             .overwrites = true},
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

/// Limits that were drawn for another place, crop or kind let rays begin where nothing of this volume is.
void RayCastEffect::check_limits(Prepare& prepare) const {
    if (params_.sampling.limits == Limits::analytic) {
        return;
    }
    const std::uint64_t own = limits_subject(
        space_.local_to_world, params_.sampling.limits == Limits::two_pass ? &params_.crop : nullptr,
        source_->volume().grid.dims);
    for (const std::string_view port : {"entry", "exit", "inner_entry", "inner_exit"}) {
        const std::uint64_t subject = prepare.subject(port);
        if (subject != 0 && subject != own) {
            prepare.log().fault("volume.other_limits",
                                "the ray caster's '" + std::string(port) +
                                    "' is drawn for another volume, place or crop, or for a mesh where "
                                    "faces are asked for: its rays begin or end in the wrong places");
        }
    }
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
    if (projects() && params_.look.overlay.used()) {
        prepare.log().fault(
            "volume.look",
            "an overlay takes no part in what '" +
                std::string(choice_names(variant_.function)[static_cast<std::size_t>(variant_.function)]) +
                "' shows");
    }
    if (const std::string_view missing = look_.load(params_.look, variant_.look, volume.grid, prepare);
        !missing.empty()) {
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
    check_limits(prepare);
    const PixelRect region = project_bounds(bounds, view.view_projection() * space_.local_to_world, size);
    if (region.empty()) {
        return Work::idle("the volume lies outside the view");
    }
    fovea_centre_ =
        params_.sampling.fovea ? params_.sampling.fovea->centre_of(prepare.frame()) : glm::dvec2(0.0);
    const std::uint64_t key = Hash()
                                  .add(parameters_key_)
                                  .add(source_->state_key())
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

}  // namespace viscera::volume
