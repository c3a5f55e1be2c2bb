#include "effects/volume/look.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera::volume {
namespace {

SourceParams source_of(const AssetPath& file, const std::string& host,
                       const std::optional<GeometryParams>& geometry) {
    SourceParams params;
    params.file = file;
    params.host = host;
    params.geometry = geometry;
    return params;
}

/// Boxes may lie anywhere; what is curved must be curved as the volume that is shown.
void expect_fitting(const Source& source, const VolumeGrid& shown, const char* where) {
    const VolumeGrid& grid = source.volume().grid;
    if (grid.curvilinear() && !same_shape(grid, shown)) {
        throw Error(ErrorCode::scene, where,
                    source.volume().source + " is " + std::string(to_string(grid.shape.kind)) +
                        " and has not the shape, origin and direction of the volume that is shown");
    }
}

}  // namespace

void LookParams::visit(ParamVisitor& v) {
    v.field({.name = "shading", .doc = "Lights and shadow (composite)."}, shading);
    v.field({.name = "labels",
             .doc = "Segments with looks of their own; what is hidden is hidden from every ray function."},
            labels);
    v.field({.name = "overlay", .doc = "A second volume that gives the hue (composite)."}, overlay);
    v.field({.name = "clip_planes", .doc = "At most 8 planes that cut the volume; they stay in the world."},
            clip_planes);
}

void LookParams::validate() const {
    shading.validate();
    labels.validate();
    overlay.validate();
    validate_clips(clip_planes);
}

std::vector<Look::Variant> Look::variants(const LookParams& params, const TransferParams& transfer) {
    const bool by_file = !transfer.file.empty();
    std::vector<Variant> all;
    for (const bool shaded : {false, true}) {
        for (const bool by_gradient : {false, true}) {
            const bool shaded_fits =
                params.shading.enabled ? shaded == *params.shading.enabled : by_file || !shaded;
            const bool gradient_fits = transfer.gradient.empty() ? by_file || !by_gradient : by_gradient;
            if (shaded_fits && gradient_fits) {
                all.push_back({true, shaded, by_gradient});
            }
        }
    }
    return all;
}

std::vector<std::string> Look::defines(const LookParams& params, const Variant& variant) {
    std::vector<std::string> names;
    if (variant.shaded) {
        names = params.shading.defines();
    }
    if (variant.by_gradient) {
        names.emplace_back("GRADIENT_OPACITY");
    }
    if (params.labels.used()) {
        names.emplace_back("LABELS");
    }
    if (!variant.composed) {
        return names;
    }
    if (params.labels.has_ramps()) {
        names.emplace_back("LABEL_RAMPS");
    }
    if (params.overlay.used()) {
        names.emplace_back("OVERLAY");
    }
    if (params.shading.light_volume.used()) {
        names.emplace_back("LIGHT_VOLUME");
    }
    return names;
}

std::string_view Look::load(const LookParams& params, const Variant& variant, const VolumeGrid& shown,
                            Prepare& prepare) {
    if (parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        label_source_ = source_of(params.labels.file, params.labels.host, params.labels.geometry);
        overlay_source_ = source_of(params.overlay.file, params.overlay.host, params.overlay.geometry);
    }
    labels_ = nullptr;
    overlay_ = nullptr;
    if (params.labels.used()) {
        labels_ = load_source(prepare.assets(), label_source_, prepare.frame());
        if (!labels_) {
            return "the host gives no label volume of this name";
        }
        expect_fitting(*labels_, shown, "/labels");
    }
    if (variant.composed && params.overlay.used()) {
        overlay_ = load_source(prepare.assets(), overlay_source_, prepare.frame());
        if (!overlay_) {
            return "the host gives no overlay of this name";
        }
        expect_fitting(*overlay_, shown, "/overlay");
    }
    return {};
}

bool Look::fits_3d(const gl::Functions& gl) const {
    int longest = 0;
    for (const Source* source : {labels_.get(), overlay_.get()}) {
        if (source != nullptr) {
            const glm::ivec3 n = source->volume().grid.dims;
            longest = std::max({longest, n.x, n.y, n.z});
        }
    }
    return longest == 0 || longest <= TextureLimits::query(gl).side_3d;
}

std::uint64_t Look::key() const {
    return Hash().add(labels_ ? labels_->state_key() : 0).add(overlay_ ? overlay_->state_key() : 0).value();
}

void Look::widen(const LookParams& params, const TransferFunction& function, const TexelMap& value_of_stored,
                 const TexelRange& stored, int entries, std::vector<StoredRange>& visible) const {
    if (!params.labels.has_ramps()) {
        return;
    }
    for (const TransferFunction& ramp : ramps(params.labels, function)) {
        const std::vector<StoredRange> more = stored_ranges(ramp, value_of_stored, stored, entries);
        visible.insert(visible.end(), more.begin(), more.end());
    }
    std::ranges::sort(visible, {}, &StoredRange::low);
    std::vector<StoredRange> joined;
    for (const StoredRange& range : visible) {
        if (!joined.empty() && range.low <= joined.back().high) {
            joined.back().high = std::max(joined.back().high, range.high);
        } else {
            joined.push_back(range);
        }
    }
    visible = std::move(joined);
}

}  // namespace viscera::volume
