#include "engine/core/volume.h"

#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/core/finite.h"
#include "engine/core/pixel_index.h"
#include "engine/core/size_text.h"

namespace viscera {

namespace {

struct ScalarInfo {
    std::string_view name;
    std::size_t bytes;
};

ScalarInfo info_of(ScalarType type) {
    static constexpr std::array<ScalarInfo, 5> infos{
        {{"u8", 1}, {"i8", 1}, {"u16", 2}, {"i16", 2}, {"f32", 4}}};
    return infos.at(static_cast<std::size_t>(type));
}

template <class T>
double load(const std::byte* bytes) {
    T value{};
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

std::string text_of(const glm::dvec3& v) {
    return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

}  // namespace

std::string_view to_string(ScalarType type) {
    return info_of(type).name;
}

std::size_t bytes_of(ScalarType type) {
    return info_of(type).bytes;
}

std::size_t VolumeGrid::voxel_count() const {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
}

glm::dmat4 VolumeGrid::index_to_world() const {
    return {glm::dvec4(direction[0] * spacing_mm.x, 0.0), glm::dvec4(direction[1] * spacing_mm.y, 0.0),
            glm::dvec4(direction[2] * spacing_mm.z, 0.0), glm::dvec4(origin_mm, 1.0)};
}

glm::dmat4 VolumeGrid::texture_to_world() const {
    // index = dims * texture - 1/2
    glm::dmat4 matrix = index_to_world();
    matrix[3] -= 0.5 * (matrix[0] + matrix[1] + matrix[2]);
    for (int axis = 0; axis < 3; ++axis) {
        matrix[axis] *= static_cast<double>(dims[axis]);
    }
    return matrix;
}

glm::dmat4 VolumeGrid::frame_to_world() const {
    return {glm::dvec4(direction[0], 0.0), glm::dvec4(direction[1], 0.0), glm::dvec4(direction[2], 0.0),
            glm::dvec4(origin_mm, 1.0)};
}

glm::dmat4 VolumeGrid::box_to_world() const {
    if (!curvilinear()) {
        return texture_to_world();
    }
    const FrameBox box = box_around(shape);
    const glm::dvec3 size = box.max - box.min;
    return frame_to_world() * glm::dmat4(glm::dvec4(size.x, 0.0, 0.0, 0.0), glm::dvec4(0.0, size.y, 0.0, 0.0),
                                         glm::dvec4(0.0, 0.0, size.z, 0.0), glm::dvec4(box.min, 1.0));
}

double VolumeGrid::diagonal_mm() const {
    return glm::length(glm::dvec3(box_to_world() * glm::dvec4(1.0, 1.0, 1.0, 0.0)));
}

glm::dvec3 VolumeGrid::world_of_index(const glm::dvec3& index) const {
    if (!curvilinear()) {
        return index_to_world() * glm::dvec4(index, 1.0);
    }
    const ShapeAxes axes = axes_of(shape, dims);
    return frame_to_world() * glm::dvec4(to_frame(shape, axes.first + index * axes.step), 1.0);
}

glm::dvec3 VolumeGrid::index_of_world(const glm::dvec3& world) const {
    if (!curvilinear()) {
        return glm::inverse(index_to_world()) * glm::dvec4(world, 1.0);
    }
    const ShapeAxes axes = axes_of(shape, dims);
    const glm::dvec3 frame = glm::inverse(direction) * (world - origin_mm);
    return (from_frame(shape, frame) - axes.first) / axes.step;
}

void VolumeGrid::validate(std::string_view where) const {
    const auto fail = [where](const std::string& message) {
        throw Error(ErrorCode::file, std::string(where), message);
    };
    constexpr double most_voxels = 288230376151711744.0;  // 2^58: sizes in bytes then fit 64 bits
    if (dims.x < 1 || dims.y < 1 || dims.z < 1) {
        fail("dims " + size_text(dims) + ": each must be 1 or more");
    }
    if (static_cast<double>(dims.x) * dims.y * dims.z > most_voxels) {
        fail("dims are beyond what any machine holds");
    }
    if (!finite(spacing_mm) || !(spacing_mm.x > 0.0 && spacing_mm.y > 0.0 && spacing_mm.z > 0.0)) {
        fail("spacing " + text_of(spacing_mm) + ": each must be finite and more than 0 mm");
    }
    if (!finite(origin_mm)) {
        fail("origin " + text_of(origin_mm) + " is not finite");
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(direction[axis]);
        if (!(std::abs(length - 1.0) < 1e-3)) {
            fail("direction: column " + std::to_string(axis) + " is no unit vector");
        }
    }
    if (!(std::abs(glm::determinant(direction)) > 1e-6)) {
        fail("direction is singular: its axes lie in one plane");
    }
    shape.validate(where);
}

double Volume::stored(const glm::ivec3& index, int channel) const {
    const std::size_t voxel = voxel_index(index, grid.dims);
    const std::size_t place = voxel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
    const std::byte* const bytes = voxels.data() + place * bytes_of(type);
    switch (type) {
        case ScalarType::u8:
            return load<std::uint8_t>(bytes);
        case ScalarType::i8:
            return load<std::int8_t>(bytes);
        case ScalarType::u16:
            return load<std::uint16_t>(bytes);
        case ScalarType::i16:
            return load<std::int16_t>(bytes);
        case ScalarType::f32:
            return load<float>(bytes);
    }
    return 0.0;
}

void Volume::validate() const {
    const auto fail = [this](const std::string& message) { throw Error(ErrorCode::file, source, message); };
    grid.validate(source);
    if (channels < 1 || channels > 4) {
        fail("channels: " + std::to_string(channels) + " are not 1 to 4");
    }
    if (!finite(slope) || slope == 0.0) {
        fail("slope " + std::to_string(slope) + " must be finite and not 0");
    }
    if (!finite(intercept)) {
        fail("intercept is not finite");
    }
    const std::size_t due = grid.voxel_count() * static_cast<std::size_t>(channels) * bytes_of(type);
    if (voxels.size() != due) {
        fail("voxels: " + std::to_string(voxels.size()) + " bytes where " + std::to_string(due) + " are due");
    }
}

}  // namespace viscera
