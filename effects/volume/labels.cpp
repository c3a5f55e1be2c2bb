#include "effects/volume/labels.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/core/error.h"

namespace viscera::volume {
namespace {

constexpr std::size_t most_segments = 4095;

/// All looks by index: the others', then each segment's.
std::vector<const SegmentLook*> looks(const LabelParams& params) {
    std::vector<const SegmentLook*> all{&params.others};
    for (const Segment& segment : params.segments) {
        all.push_back(&segment.look);
    }
    return all;
}

/// From labels to looks.
class LookIndex {
  public:
    explicit LookIndex(const LabelParams& params) {
        for (std::size_t i = 0; i < params.segments.size(); ++i) {
            index_of_[params.segments[i].id] = static_cast<std::uint16_t>(i + 1);
        }
    }

    std::uint16_t of(double label) {
        if (label != last_) {
            broken_ = !(label == std::floor(label) && std::isfinite(label));
            const auto found = std::isnan(label) ? index_of_.end() : index_of_.find(label);
            last_ = label;
            last_index_ = found == index_of_.end() ? std::uint16_t{0} : found->second;
        }
        return last_index_;
    }
    /// Whether the last one was no whole number.
    [[nodiscard]] bool broken() const { return broken_; }

  private:
    std::map<double, std::uint16_t> index_of_;
    double last_ = 0.5;  ///< labels come in runs
    std::uint16_t last_index_ = 0;
    bool broken_ = true;
};

}  // namespace

void SegmentLook::visit(ParamVisitor& v) {
    v.field({.name = "visible", .doc = "Whether anything of it is shown."}, visible);
    v.field({.name = "colour",
             .doc = "red, green, blue, linear; by default the transfer function's",
             .min = 0.0,
             .max = 1.0},
            colour);
    v.field({.name = "colour_weight",
             .doc = "1: the colour takes the place of the transfer function's; less: it tints it.",
             .min = 0.0,
             .max = 1.0},
            colour_weight);
    v.field({.name = "opacity_factor", .doc = "Factor on the extinction.", .min = 0.0, .max = 1000.0},
            opacity_factor);
    v.field({.name = "points", .doc = "Knots of a transfer function of its own."}, points);
}

void Segment::visit(ParamVisitor& v) {
    v.field({.name = "id", .doc = "Value of the label volume.", .required = true}, id);
    look.visit(v);
}

void LabelParams::visit(ParamVisitor& v) {
    v.field({.name = "file", .doc = "Volume of whole numbers, one for each segment."}, file);
    v.field({.name = "host", .doc = "Name of a volume that the host gives, instead of a file."}, host);
    v.field({.name = "geometry", .doc = "What the file's axes run along, as in volume."}, geometry);
    v.field({.name = "segments", .doc = "What single labels look like."}, segments);
    v.field({.name = "others", .doc = "What all labels that are not listed look like."}, others);
}

int LabelParams::ramp_count() const {
    const auto own =
        std::ranges::count_if(segments, [](const Segment& segment) { return !segment.look.points.empty(); });
    return static_cast<int>(own) + (others.points.empty() ? 0 : 1);
}

void LabelParams::validate() const {
    if (!file.empty() && !host.empty()) {
        throw Error(ErrorCode::scene, "/labels", "has either a file or a host's volume");
    }
    if (!used() && !segments.empty()) {
        throw Error(ErrorCode::scene, "/labels", "has segments, but neither a file nor a host's volume");
    }
    if (segments.size() > most_segments) {
        throw Error(ErrorCode::scene, "/labels/segments",
                    "at most " + std::to_string(most_segments) + " segments");
    }
    std::map<int, std::size_t> seen;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (!seen.try_emplace(segments[i].id, i).second) {
            throw Error(ErrorCode::scene, "/labels/segments/" + std::to_string(i) + "/id", "is listed twice");
        }
    }
}

std::vector<std::uint16_t> dense_labels(const Volume& labels, const LabelParams& params,
                                        std::size_t& broken) {
    LookIndex index(params);
    std::vector<std::uint16_t> dense;
    dense.reserve(labels.grid.voxel_count());
    const glm::ivec3 n = labels.grid.dims;
    for (int z = 0; z < n.z; ++z) {
        for (int y = 0; y < n.y; ++y) {
            for (int x = 0; x < n.x; ++x) {
                dense.push_back(index.of(labels.value_of(labels.stored({x, y, z}))));
                broken += index.broken() ? 1 : 0;
            }
        }
    }
    return dense;
}

std::function<std::uint16_t(const glm::ivec3& voxel)> labels_at(const Volume& labels,
                                                                const LabelParams& params,
                                                                const VolumeGrid& shown) {
    const VolumeGrid& grid = labels.grid;
    const bool straight = !grid.curvilinear() && !shown.curvilinear();
    const glm::dmat4 map =
        straight ? glm::inverse(grid.index_to_world()) * shown.index_to_world() : glm::dmat4(1.0);
    return [&labels, shown, straight, map, index = LookIndex(params)](const glm::ivec3& voxel) mutable {
        const VolumeGrid& own = labels.grid;
        const glm::dvec3 place = straight ? glm::dvec3(map * glm::dvec4(glm::dvec3(voxel), 1.0))
                                          : own.index_of_world(shown.world_of_index(glm::dvec3(voxel)));
        glm::ivec3 at(glm::floor(place + 0.5));
        if (const int ring = own.shape.wrap_axis(); ring >= 0) {
            at[ring] = (at[ring] % own.dims[ring] + own.dims[ring]) % own.dims[ring];
        }
        const bool inside =
            glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, own.dims));
        return inside ? index.of(labels.value_of(labels.stored(at))) : std::uint16_t{0};
    };
}

gl::Texture label_texture(const gl::Functions& gl, const Volume& labels, std::span<const std::uint16_t> dense,
                          const std::optional<AtlasLayout>& atlas) {
    const glm::ivec3 n = labels.grid.dims;
    if (!atlas) {
        gl::Texture texture = gl::Texture::make_3d(gl, {n.x, n.y, n.z}, gl::r16ui_format, labels.source);
        texture.upload(std::as_bytes(dense));
        return texture;
    }
    gl::Texture texture = gl::Texture::make_2d_array(gl, {atlas->page().x, atlas->page().y, atlas->layers},
                                                     gl::r16ui_format, labels.source);
    const auto slice = static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y);
    for (int z = 0; z < n.z; ++z) {
        const glm::ivec3 place = atlas->place_of(z);
        texture.upload_region({place.x, place.y, place.z}, {n.x, n.y, 1},
                              std::as_bytes(dense.subspan(static_cast<std::size_t>(z) * slice, slice)));
    }
    return texture;
}

std::vector<glm::vec4> look_table(const LabelParams& params) {
    const std::vector<const SegmentLook*> all = looks(params);
    std::vector<glm::vec4> table(2 * all.size());
    int row = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const SegmentLook& look = *all[i];
        const double weight = look.colour ? look.colour_weight : 0.0;
        table[i] = glm::dvec4(look.colour.value_or(glm::dvec3(0.0)), weight);
        row += look.points.empty() ? 0 : 1;
        table[all.size() + i] =
            glm::dvec4(look.visible ? look.opacity_factor : 0.0, look.points.empty() ? 0.0 : row, 0.0, 0.0);
    }
    return table;
}

std::vector<TransferFunction> ramps(const LabelParams& params, const TransferFunction& function) {
    std::vector<TransferFunction> result;
    for (const SegmentLook* look : looks(params)) {
        if (!look->points.empty()) {
            std::size_t faults = 0;
            result.push_back(normalised(
                TransferFunction{.points = look->points, .reference_length_mm = function.reference_length_mm},
                faults));
        }
    }
    return result;
}

}  // namespace viscera::volume
