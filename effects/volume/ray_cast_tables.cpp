#include <algorithm>

#include "effects/volume/ray_cast_effect.h"

// What values look like: the transfer function, and the tables on the GPU that are made of it.
namespace viscera::volume {
namespace {

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

void RayCastEffect::find_function(Prepare& prepare) {
    function_ = load_function(params_.transfer_function, prepare.assets());
    const RayFunction wanted = params_.function.value_or(function_for(function_.technique));
    variant_.function = marched_as(wanted);
    std::size_t faults = 0;
    if (wanted == RayFunction::density) {
        function_ = normalised(density_function(function_, params_.density), faults);
    } else if (wanted == RayFunction::accumulate) {
        const std::vector<GradientPoint> gradient = std::move(function_.gradient);
        function_ =
            normalised(accumulate_function(params_.accumulate, source_->statistics.min,
                                           source_->statistics.max, source_->volume().grid.diagonal_mm()),
                       faults);
        if (!shows_colours()) {
            function_.gradient = gradient;
        }
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
    if (params_.sampling.scheme == Scheme::preintegrated && !projects()) {
        make_slabs(gl, stored_of_texel);
    }
    // Last: it says that all is made.
    table_.make(gl, table_of_texel(stored_of_texel), parameters_key_, *source_);
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
}  // namespace viscera::volume
