#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/volume.h"
#include "tests/reference/volume_polynomial.h"

namespace viscera::reference {

/// How voxels become a field. nearest: the voxel that owns the place. trilinear: piecewise linear between
/// voxel centres. bspline: cubic B-spline with the voxels as coefficients (smooths). bspline_prefiltered:
/// cubic B-spline through the voxels. catmull_rom: Keys' cubic with a = -1/2 (interpolates).
enum class Filter { nearest, trilinear, bspline, bspline_prefiltered, catmull_rom };
inline constexpr std::array all_filters{Filter::nearest, Filter::trilinear, Filter::bspline,
                                        Filter::bspline_prefiltered, Filter::catmull_rom};

/// What lies beyond the outermost voxels: the outermost voxel's value (GL_CLAMP_TO_EDGE), or the volume
/// mirrored at the outermost voxel's centre (f(-1) = f(1)). For bspline_prefiltered it says how coefficients
/// go on, in the prefilter and in the look-up alike; with both the field passes through every voxel.
enum class Edge { clamp, mirror };

/// A scalar field over texture coordinates t of the box [0, 1]^3, placed in the world by `texture_to_world`
/// (any affine matrix that is not singular; model matrices are multiplied into it). Voxel i's centre lies at
/// t = (i + 0.5) / n. Copies share the voxels.
class Field {
  public:
    using Value = std::function<double(const glm::dvec3& t)>;
    using Gradient = std::function<glm::dvec3(const glm::dvec3& t)>;

    /// Samples x fastest, dims.x * dims.y * dims.z of them.
    Field(const glm::ivec3& dims, std::vector<double> samples, Filter filter,
          const glm::dmat4& texture_to_world = glm::dmat4(1.0), Edge edge = Edge::clamp);
    /// One channel of a volume, rescaled (slope and intercept). Voxels that are not finite get the value
    /// `empty`; none: the least finite value of the channel.
    Field(const Volume& volume, Filter filter, int channel = 0, std::optional<double> empty = {},
          Edge edge = Edge::clamp);
    /// An analytic field and its gradient per texture unit. Without a gradient, gradient() is a central
    /// difference of 1e-6 and good to about 1e-9 of the field's range. Ray functions approximate the field
    /// along a ray by polynomials to about 1e-13 of its range, so it should be piecewise smooth.
    Field(Value value, Gradient gradient, const glm::dmat4& texture_to_world = glm::dmat4(1.0));
    /// An analytic field f(p) over world coordinates [mm] in a box given by `texture_to_world`; gradient per
    /// mm.
    static Field in_world(Value value_mm, Gradient gradient_mm, const glm::dmat4& texture_to_world);

    [[nodiscard]] double value(const glm::dvec3& t) const;
    /// The filter's analytic derivative, per texture unit. At cell faces, where a trilinear field has a kink,
    /// that of the cell with the greater index. nearest: 0.
    [[nodiscard]] glm::dvec3 gradient(const glm::dvec3& t) const;
    /// Central difference of one voxel to either side through value(), per texture unit. An analytic field
    /// takes its voxels from with_voxels().
    [[nodiscard]] glm::dvec3 central_difference(const glm::dvec3& t) const;
    /// A gradient per texture unit as one per mm in the world: the inverse transpose of texture_to_world, so
    /// that it stays normal to iso-surfaces under non-uniform scale, mirror and shear.
    [[nodiscard]] glm::dvec3 to_world_gradient(const glm::dvec3& per_texture_unit) const;

    [[nodiscard]] const glm::dmat4& texture_to_world() const { return texture_to_world_; }
    [[nodiscard]] const glm::dmat4& world_to_texture() const { return world_to_texture_; }
    /// The same field, moved by a model matrix: texture_to_world becomes model * texture_to_world.
    [[nodiscard]] Field moved(const glm::dmat4& model) const;
    /// The same analytic field with a voxel size for central_difference.
    [[nodiscard]] Field with_voxels(const glm::ivec3& dims) const;

    [[nodiscard]] const glm::ivec3& dims() const { return dims_; }
    [[nodiscard]] bool analytic() const { return !samples_; }
    [[nodiscard]] Filter filter() const { return filter_; }
    /// What the field interpolates (bspline_prefiltered: its coefficients), beyond the edge as Edge says.
    [[nodiscard]] double sample(const glm::ivec3& index) const;

    /// The field along a line inside one cell, exactly: index coordinates x(u) = middle + half u for u in
    /// [-1, 1], where x = t * dims - 0.5. `cell` is floor(x) (nearest: the voxel, floor(x + 0.5)). Only for
    /// voxel fields.
    [[nodiscard]] Polynomial along(const glm::ivec3& cell, const glm::dvec3& middle,
                                   const glm::dvec3& half) const;

  private:
    [[nodiscard]] double tensor(const glm::dvec3& t, int derivative_axis) const;
    template <int Support>
    [[nodiscard]] Polynomial along_cell(const glm::ivec3& cell, const glm::dvec3& middle,
                                        const glm::dvec3& half) const;

    glm::ivec3 dims_{1};
    Filter filter_ = Filter::trilinear;
    Edge edge_ = Edge::clamp;
    std::shared_ptr<const std::vector<double>> samples_;
    Value value_;
    Gradient gradient_;
    glm::dmat4 texture_to_world_{1.0};
    glm::dmat4 world_to_texture_{1.0};
};

/// A volume's voxels as doubles, rescaled; not finite ones as `empty` (none: the least finite value, 0 if
/// there is none).
[[nodiscard]] std::vector<double> decoded(const Volume& volume, int channel = 0,
                                          std::optional<double> empty = {});

/// texture_to_world of a grid: t -> origin + direction * (spacing * (t * dims - 0.5)).
[[nodiscard]] glm::dmat4 texture_to_world_of(const VolumeGrid& grid);

/// B-spline coefficients c with (c[i-1] + 4 c[i] + c[i+1]) / 6 = samples[i] along each axis in turn, solved
/// exactly by recursion (one sweep forwards, one back).
[[nodiscard]] std::vector<double> bspline_coefficients(const glm::ivec3& dims, std::vector<double> samples,
                                                       Edge edge);

}  // namespace viscera::reference
