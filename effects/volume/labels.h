#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/atlas.h"
#include "effects/volume/classification.h"
#include "effects/volume/source.h"
#include "engine/core/log.h"
#include "engine/gl/texture.h"

namespace viscera::volume {

/// How a segment looks.
struct SegmentLook {
    bool visible = true;
    std::optional<glm::dvec3> colour;
    double colour_weight = 1.0;  ///< 1 replaces the transfer function's colour, less tints it
    double opacity_factor = 1.0;
    std::vector<TransferPoint> points;  ///< own transfer function

    void visit(ParamVisitor& v);
};

struct Segment {
    int id = 0;
    SegmentLook look;

    void visit(ParamVisitor& v);
};

/// A volume of labels in the same world as the one that is shown, with a grid of its own.
struct LabelParams {
    AssetPath file;
    std::string host;
    std::optional<GeometryParams> geometry;  ///< of the file, as in SourceParams
    std::vector<Segment> segments;
    SegmentLook others;

    void visit(ParamVisitor& v);
    [[nodiscard]] bool used() const { return !file.empty() || !host.empty(); }
    /// How many looks have a transfer function of their own.
    [[nodiscard]] int ramp_count() const;
    [[nodiscard]] bool has_ramps() const { return used() && ramp_count() > 0; }
    /// Throws Error(scene): file and host, an id listed twice.
    void validate() const;
};

/// Labels as indices: i + 1 for segments[i].id, 0 for everything else, so that ids may be sparse and of any
/// size. x fastest. `broken` counts labels that are no whole number; they count as not listed.
[[nodiscard]] std::vector<std::uint16_t> dense_labels(const Volume& labels, const LabelParams& params,
                                                      std::size_t& broken);

/// The same at the centres of the voxels of the volume that is shown; 0 beside the labels, which must outlive
/// it.
[[nodiscard]] std::function<std::uint16_t(const glm::ivec3& voxel)> labels_at(const Volume& labels,
                                                                              const LabelParams& params,
                                                                              const VolumeGrid& shown);

/// The result of dense_labels() as glsl/volume/labels.glsl reads it: a 3-D texture, or slice by slice.
[[nodiscard]] gl::Texture label_texture(const gl::Functions& gl, const Volume& labels,
                                        std::span<const std::uint16_t> dense,
                                        const std::optional<AtlasLayout>& atlas);

/// The looks as glsl/volume/labels.glsl reads them: one column per index, two rows.
[[nodiscard]] std::vector<glm::vec4> look_table(const LabelParams& params);

/// The transfer functions of rows 1, 2, ... of the ramp table, in the order of the looks that have one
/// (others first). Reference length as of the main function.
[[nodiscard]] std::vector<TransferFunction> ramps(const LabelParams& params,
                                                  const TransferFunction& function);

}  // namespace viscera::volume
