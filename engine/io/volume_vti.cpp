#include <algorithm>
#include <map>
#include <optional>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"
#include "engine/io/vtk_xml.h"

namespace viscera::io {

namespace {

FileScalar vtk_type(std::string_view name, const Reading& reading) {
    static const std::map<std::string_view, FileScalar> types{
        {"UInt8", FileScalar::u8},   {"Int8", FileScalar::i8},    {"UInt16", FileScalar::u16},
        {"Int16", FileScalar::i16},  {"UInt32", FileScalar::u32}, {"Int32", FileScalar::i32},
        {"UInt64", FileScalar::u64}, {"Int64", FileScalar::i64},  {"Float32", FileScalar::f32},
        {"Float64", FileScalar::f64}};
    const auto found = types.find(name);
    if (found == types.end()) {
        reading.fail("type '" + printable(name) + "' is not read");
    }
    return found->second;
}

std::vector<double> attribute(const pugi::xml_node& node, const char* name, std::size_t count,
                              const Reading& reading) {
    std::vector<double> numbers = numbers_of(node.attribute(name).value(), name, reading);
    if (numbers.size() != count) {
        reading.fail(std::string(name) + " needs " + std::to_string(count) + " numbers");
    }
    return numbers;
}

VolumeGrid grid_of(const pugi::xml_node& image, const pugi::xml_node& piece, const Reading& reading) {
    constexpr double most = 1e9;
    VolumeGrid grid;
    const std::vector<double> extent = attribute(piece, "Extent", 6, reading);
    if (attribute(image, "WholeExtent", 6, reading) != extent) {
        reading.fail("Extent: the piece is not the whole");
    }
    glm::dvec3 first{};
    std::vector<double> sizes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(std::abs(extent[2 * axis]) <= most && std::abs(extent[2 * axis + 1]) <= most)) {
            reading.fail("Extent is out of range");
        }
        sizes.push_back(extent[2 * axis + 1] - extent[2 * axis] + 1.0);
        first[static_cast<int>(axis)] = extent[2 * axis];
    }
    grid.dims = dims_of(sizes, "Extent", reading);
    if (image.attribute("Spacing")) {
        const std::vector<double> v = attribute(image, "Spacing", 3, reading);
        grid.spacing_mm = {v[0], v[1], v[2]};
    }
    if (image.attribute("Origin")) {
        const std::vector<double> v = attribute(image, "Origin", 3, reading);
        grid.origin_mm = {v[0], v[1], v[2]};
    }
    if (image.attribute("Direction")) {
        const std::vector<double> d = attribute(image, "Direction", 9, reading);
        grid.direction = glm::transpose(glm::dmat3(d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8]));
    }
    grid.validate(reading.file.string());
    // The origin is that of index 0, which need not be the first voxel.
    grid.origin_mm += grid.direction * (grid.spacing_mm * first);
    return grid;
}

/// The array that PointData names as its scalars, else the first of numbers.
pugi::xml_node scalars_of(const pugi::xml_node& piece, const Reading& reading) {
    const pugi::xml_node data = piece.child("PointData");
    if (const char* name = data.attribute("Scalars").value(); *name != '\0') {
        if (const pugi::xml_node found = data.find_child_by_attribute("DataArray", "Name", name)) {
            return found;
        }
    }
    for (const pugi::xml_node array : data.children("DataArray")) {
        if (std::string_view(array.attribute("type").value()) != "String") {
            return array;
        }
    }
    reading.fail("has no values at points");
}

Volume read_image_data(const VtkXml& xml, const Reading& reading) {
    const pugi::xml_node image = xml.root().child("ImageData");
    const pugi::xml_node piece = image.child("Piece");
    if (!piece || piece.next_sibling("Piece")) {
        reading.fail("has no Piece or several; one is read");
    }
    VolumeHead head;
    head.volume.grid = grid_of(image, piece, reading);
    const pugi::xml_node array = scalars_of(piece, reading);
    head.type = vtk_type(array.attribute("type").value(), reading);
    head.volume.channels = static_cast<int>(whole_number(array.attribute("NumberOfComponents").as_string("1"),
                                                         "NumberOfComponents", 1.0, 4.0, reading));
    const std::uint64_t due = head.bytes(reading);
    const auto require = [&](std::uint64_t bytes) {
        if (bytes != due) {
            reading.fail("array '" + printable(array.attribute("Name").value()) + "' has " +
                         std::to_string(bytes) + " bytes where " + std::to_string(due) + " are due");
        }
    };
    if (VtkXml::is_text(array)) {
        const std::vector<double> numbers = xml.values(array);
        require(numbers.size() * bytes_of(head.type));
        const std::vector<std::byte> bytes = encode(numbers, head.type, reading);
        return read_voxels(head, read_from_memory(bytes, reading), reading);
    }
    head.big_endian = xml.is_big_endian();
    const std::string bytes = xml.bytes(array);
    require(bytes.size());
    return read_voxels(head, read_from_memory(std::as_bytes(std::span(bytes)), reading), reading);
}

}  // namespace

Volume read_vti(const Reading& reading) {
    try {
        return read_image_data(VtkXml(read_file(reading.file), "ImageData"), reading);
    } catch (const Error&) {
        throw;
    } catch (const std::runtime_error& error) {
        reading.fail(error.what());
    }
}

}  // namespace viscera::io
