#include "tests/reference/volume_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace viscera::reference {
namespace {

/// Weights of the samples around a place as polynomials of the fraction a in [0, 1]: row k belongs to sample
/// first + k, column j to a^j.
struct Kernel {
    int support = 1;
    int first = 0;
    std::array<std::array<double, 4>, 4> m{};
};

constexpr Kernel nearest_kernel{1, 0, {{{1.0, 0.0, 0.0, 0.0}}}};
constexpr Kernel trilinear_kernel{2, 0, {{{1.0, -1.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}}}};
constexpr Kernel bspline_kernel{4,
                                -1,
                                {{{1.0 / 6.0, -0.5, 0.5, -1.0 / 6.0},
                                  {2.0 / 3.0, 0.0, -1.0, 0.5},
                                  {1.0 / 6.0, 0.5, 0.5, -0.5},
                                  {0.0, 0.0, 0.0, 1.0 / 6.0}}}};
constexpr Kernel catmull_rom_kernel{
    4, -1, {{{0.0, -0.5, 1.0, -0.5}, {1.0, 0.0, -2.5, 1.5}, {0.0, 0.5, 2.0, -1.5}, {0.0, 0.0, -0.5, 0.5}}}};

const Kernel& kernel_of(Filter filter) {
    switch (filter) {
        case Filter::nearest:
            return nearest_kernel;
        case Filter::trilinear:
            return trilinear_kernel;
        case Filter::bspline:
        case Filter::bspline_prefiltered:
            return bspline_kernel;
        case Filter::catmull_rom:
            return catmull_rom_kernel;
    }
    return trilinear_kernel;
}

int inside(int index, int n, Edge edge) {
    if (index >= 0 && index < n) {
        return index;
    }
    if (edge == Edge::clamp || n == 1) {
        return std::clamp(index, 0, n - 1);
    }
    const int period = 2 * (n - 1);
    const int folded = ((index % period) + period) % period;
    return folded < n ? folded : period - folded;
}

std::size_t position(const glm::ivec3& dims, int x, int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(dims.x) +
           static_cast<std::size_t>(x);
}

/// Solves one line of bspline_coefficients in place. `stride` lies between its samples.
void prefilter_line(double* line, int n, std::size_t stride, Edge edge, std::vector<double>& scratch) {
    if (n == 1) {
        return;
    }
    const double side = edge == Edge::mirror ? 2.0 : 1.0;    // weight of the inner neighbour at an end
    const double middle = edge == Edge::mirror ? 4.0 : 5.0;  // weight of the end itself
    scratch.resize(static_cast<std::size_t>(n));
    scratch[0] = side / middle;
    line[0] *= 6.0 / middle;
    for (int i = 1; i < n; ++i) {
        const bool last = i == n - 1;
        const auto k = static_cast<std::size_t>(i);
        const double below = last ? side : 1.0;
        const double pivot = (last ? middle : 4.0) - below * scratch[k - 1];
        scratch[k] = 1.0 / pivot;
        line[k * stride] = (6.0 * line[k * stride] - below * line[(k - 1) * stride]) / pivot;
    }
    for (int i = n - 2; i >= 0; --i) {
        const auto k = static_cast<std::size_t>(i);
        line[k * stride] -= scratch[k] * line[(k + 1) * stride];
    }
}

template <class T>
double stored_as(const std::byte* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return static_cast<double>(value);
}

using Decode = double (*)(const std::byte*);
struct Layout {
    std::size_t size;
    Decode decode;
};
Layout layout_of(ScalarType type) {
    switch (type) {
        case ScalarType::u8:
            return {1, stored_as<std::uint8_t>};
        case ScalarType::i8:
            return {1, stored_as<std::int8_t>};
        case ScalarType::u16:
            return {2, stored_as<std::uint16_t>};
        case ScalarType::i16:
            return {2, stored_as<std::int16_t>};
        case ScalarType::f32:
            break;
    }
    return {4, stored_as<float>};
}

}  // namespace

Field::Field(const glm::ivec3& dims, std::vector<double> samples, Filter filter,
             const glm::dmat4& texture_to_world, Edge edge)
    : dims_(dims),
      filter_(filter),
      edge_(edge),
      samples_(std::make_shared<const std::vector<double>>(
          filter == Filter::bspline_prefiltered ? bspline_coefficients(dims, std::move(samples), edge)
                                                : std::move(samples))),
      texture_to_world_(texture_to_world),
      world_to_texture_(glm::inverse(texture_to_world)) {}

Field::Field(const Volume& volume, Filter filter, int channel, std::optional<double> empty, Edge edge)
    : Field(volume.grid.dims, decoded(volume, channel, empty), filter, texture_to_world_of(volume.grid),
            edge) {}

Field::Field(Value value, Gradient gradient, const glm::dmat4& texture_to_world)
    : value_(std::move(value)),
      gradient_(std::move(gradient)),
      texture_to_world_(texture_to_world),
      world_to_texture_(glm::inverse(texture_to_world)) {}

Field Field::in_world(Value value_mm, Gradient gradient_mm, const glm::dmat4& texture_to_world) {
    const auto to_world = [texture_to_world](const glm::dvec3& t) {
        return glm::dvec3(texture_to_world * glm::dvec4(t, 1.0));
    };
    Gradient gradient;
    if (gradient_mm) {
        gradient = [to_world, gradient_mm, turn = glm::transpose(glm::dmat3(texture_to_world))](
                       const glm::dvec3& t) { return turn * gradient_mm(to_world(t)); };
    }
    return {[to_world, value_mm](const glm::dvec3& t) { return value_mm(to_world(t)); }, gradient,
            texture_to_world};
}

Field Field::moved(const glm::dmat4& model) const {
    Field result = *this;
    result.texture_to_world_ = model * texture_to_world_;
    result.world_to_texture_ = glm::inverse(result.texture_to_world_);
    return result;
}

Field Field::with_voxels(const glm::ivec3& dims) const {
    Field result = *this;
    if (analytic()) {
        result.dims_ = dims;
    }
    return result;
}

double Field::sample(const glm::ivec3& index) const {
    return (*samples_)[position(dims_, inside(index.x, dims_.x, edge_), inside(index.y, dims_.y, edge_),
                                inside(index.z, dims_.z, edge_))];
}

double Field::tensor(const glm::dvec3& t, int derivative_axis) const {
    const Kernel& kernel = kernel_of(filter_);
    const glm::dvec3 x = t * glm::dvec3(dims_) - 0.5;
    std::array<std::array<double, 4>, 3> weights{};
    glm::ivec3 first;
    for (int axis = 0; axis < 3; ++axis) {
        // Far outside, the same as just outside; keeps the conversion to int defined.
        const double place = std::clamp(x[axis], -4.0, dims_[axis] + 4.0);
        const double cell = std::floor(filter_ == Filter::nearest ? place + 0.5 : place);
        const double a = place - cell;
        first[axis] = static_cast<int>(cell) + kernel.first;
        for (std::size_t k = 0; k < static_cast<std::size_t>(kernel.support); ++k) {
            const auto& m = kernel.m[k];
            weights[static_cast<std::size_t>(axis)][k] = axis == derivative_axis
                                                             ? m[1] + a * (2.0 * m[2] + a * 3.0 * m[3])
                                                             : m[0] + a * (m[1] + a * (m[2] + a * m[3]));
        }
    }
    double sum = 0.0;
    for (int z = 0; z < kernel.support; ++z) {
        double plane = 0.0;
        for (int y = 0; y < kernel.support; ++y) {
            double row = 0.0;
            for (int i = 0; i < kernel.support; ++i) {
                row += weights[0][static_cast<std::size_t>(i)] * sample(first + glm::ivec3(i, y, z));
            }
            plane += weights[1][static_cast<std::size_t>(y)] * row;
        }
        sum += weights[2][static_cast<std::size_t>(z)] * plane;
    }
    return derivative_axis < 0 ? sum : sum * dims_[derivative_axis];
}

double Field::value(const glm::dvec3& t) const {
    return analytic() ? value_(t) : tensor(t, -1);
}

glm::dvec3 Field::gradient(const glm::dvec3& t) const {
    if (!analytic()) {
        return {tensor(t, 0), tensor(t, 1), tensor(t, 2)};
    }
    if (gradient_) {
        return gradient_(t);
    }
    glm::dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = 1e-6;
        result[axis] = (value_(t + step) - value_(t - step)) / 2e-6;
    }
    return result;
}

glm::dvec3 Field::central_difference(const glm::dvec3& t) const {
    glm::dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = 1.0 / dims_[axis];
        result[axis] = 0.5 * dims_[axis] * (value(t + step) - value(t - step));
    }
    return result;
}

glm::dvec3 Field::to_world_gradient(const glm::dvec3& per_texture_unit) const {
    return glm::transpose(glm::dmat3(world_to_texture_)) * per_texture_unit;
}

template <int Support>
Polynomial Field::along_cell(const glm::ivec3& cell, const glm::dvec3& middle, const glm::dvec3& half) const {
    constexpr int degree = Support - 1;
    constexpr auto support = static_cast<std::size_t>(Support);
    const Kernel& kernel = kernel_of(filter_);
    // Each axis's weights as polynomials of u: the kernel's, with a = middle - cell + half u.
    std::array<std::array<std::array<double, support>, support>, 3> w;
    std::array<std::array<std::size_t, support>, 3> at;
    std::size_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(axis);
        const double a = middle[axis] - cell[axis];
        const double h = half[axis];
        for (std::size_t k = 0; k < support; ++k) {
            const auto& m = kernel.m[k];
            w[n][k][0] = m[0] + a * (m[1] + a * (m[2] + a * m[3]));
            if constexpr (degree >= 1) {
                w[n][k][1] = h * (m[1] + a * (2.0 * m[2] + a * 3.0 * m[3]));
            }
            if constexpr (degree >= 3) {
                w[n][k][2] = h * h * (m[2] + a * 3.0 * m[3]);
                w[n][k][3] = h * h * h * m[3];
            }
            at[n][k] = stride * static_cast<std::size_t>(inside(
                                    cell[axis] + kernel.first + static_cast<int>(k), dims_[axis], edge_));
        }
        stride *= static_cast<std::size_t>(dims_[axis]);
    }
    Polynomial result;
    result.degree = 3 * degree;
    const double* voxels = samples_->data();
    for (std::size_t z = 0; z < support; ++z) {
        std::array<double, 2 * degree + 1> plane{};
        for (std::size_t y = 0; y < support; ++y) {
            std::array<double, support> row{};
            const double* line = voxels + at[2][z] + at[1][y];
            for (std::size_t x = 0; x < support; ++x) {
                const double voxel = line[at[0][x]];
                for (std::size_t k = 0; k < support; ++k) {
                    row[k] += voxel * w[0][x][k];
                }
            }
            for (std::size_t i = 0; i < support; ++i) {
                for (std::size_t k = 0; k < support; ++k) {
                    plane[i + k] += row[i] * w[1][y][k];
                }
            }
        }
        for (std::size_t i = 0; i < plane.size(); ++i) {
            for (std::size_t k = 0; k < support; ++k) {
                result.c[i + k] += plane[i] * w[2][z][k];
            }
        }
    }
    return result;
}

Polynomial Field::along(const glm::ivec3& cell, const glm::dvec3& middle, const glm::dvec3& half) const {
    switch (kernel_of(filter_).support) {
        case 1:
            return along_cell<1>(cell, middle, half);
        case 2:
            return along_cell<2>(cell, middle, half);
        default:
            return along_cell<4>(cell, middle, half);
    }
}

std::vector<double> decoded(const Volume& volume, int channel, std::optional<double> empty) {
    const glm::ivec3& dims = volume.grid.dims;
    const std::size_t count = position(dims, 0, 0, dims.z);
    const Layout layout = layout_of(volume.type);
    std::vector<double> values(count);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t scalar =
            i * static_cast<std::size_t>(volume.channels) + static_cast<std::size_t>(channel);
        values[i] =
            volume.slope * layout.decode(volume.voxels.data() + scalar * layout.size) + volume.intercept;
        if (std::isfinite(values[i])) {
            least = std::min(least, values[i]);
        }
    }
    const double filler = empty.value_or(std::isfinite(least) ? least : 0.0);
    for (double& value : values) {
        value = std::isfinite(value) ? value : filler;
    }
    return values;
}

glm::dmat4 texture_to_world_of(const VolumeGrid& grid) {
    const glm::dvec3 dims(grid.dims);
    glm::dmat4 result(1.0);
    glm::dvec3 corner = grid.origin_mm;
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 voxel = grid.direction[axis] * grid.spacing_mm[axis];
        result[axis] = glm::dvec4(voxel * dims[axis], 0.0);
        corner -= 0.5 * voxel;
    }
    result[3] = glm::dvec4(corner, 1.0);
    return result;
}

std::vector<double> bspline_coefficients(const glm::ivec3& dims, std::vector<double> samples, Edge edge) {
    std::vector<double> scratch;
    const std::array<std::size_t, 3> strides{1, position(dims, 0, 1, 0), position(dims, 0, 0, 1)};
    for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 lines = dims;
        lines[axis] = 1;
        for (int z = 0; z < lines.z; ++z) {
            for (int y = 0; y < lines.y; ++y) {
                for (int x = 0; x < lines.x; ++x) {
                    prefilter_line(samples.data() + position(dims, x, y, z), dims[axis],
                                   strides[static_cast<std::size_t>(axis)], edge, scratch);
                }
            }
        }
    }
    return samples;
}

}  // namespace viscera::reference
