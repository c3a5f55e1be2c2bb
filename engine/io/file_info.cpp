#include "engine/io/file_info.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh.h"
#include "engine/io/png.h"
#include "engine/io/volume.h"
#include "engine/io/vtp.h"

namespace viscera::io {

namespace {

using Json = nlohmann::json;

template <class Vector>
Json numbers_json(const Vector& p) {
    return {p.x, p.y, p.z};
}

/// Whether every edge belongs to two triangles that run along it in opposite directions, seams of normals or
/// texture closed. That is a surface without border and of one orientation.
bool is_closed(const MeshData& mesh) {
    if (mesh.indices.empty()) {
        return false;
    }
    const std::vector<std::uint32_t> place = first_at_same_place(mesh.positions);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const std::uint32_t a = place[mesh.indices[i]];
        const std::uint32_t b = place[mesh.indices[i % 3 == 2 ? i - 2 : i + 1]];
        balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
    return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

/// Volume that the triangles enclose, positive where they run counter-clockwise seen from outside [mm^3].
double signed_volume_mm3(const MeshData& mesh) {
    if (mesh.positions.empty()) {
        return 0.0;
    }
    const glm::dvec3 origin(mesh.positions.front());
    double volume = 0.0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::dvec3 a = glm::dvec3(mesh.positions[mesh.indices[t]]) - origin;
        const glm::dvec3 b = glm::dvec3(mesh.positions[mesh.indices[t + 1]]) - origin;
        const glm::dvec3 c = glm::dvec3(mesh.positions[mesh.indices[t + 2]]) - origin;
        volume += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return volume;
}

Json describe_mesh(const MeshData& mesh) {
    Json scalars = Json::array();
    for (const VertexScalars& one : mesh.scalars) {
        const auto [low, high] = std::ranges::minmax_element(one.values);
        Json entry = {{"name", one.name}};
        if (!one.values.empty()) {
            entry["min"] = *low;
            entry["max"] = *high;
        }
        scalars.push_back(std::move(entry));
    }
    Json result = {{"name", mesh.name},
                   {"vertices", mesh.positions.size()},
                   {"triangles", mesh.triangle_count()},
                   {"normals", !mesh.normals.empty()},
                   {"uv", !mesh.uvs.empty()},
                   {"scalars", std::move(scalars)}};
    if (mesh.indices.empty()) {
        return result;
    }
    const Bounds bounds = mesh.bounds();
    result["bounds_mm"] = {{"min", numbers_json(bounds.min)}, {"max", numbers_json(bounds.max)}};
    const bool closed = is_closed(mesh);
    result["closed"] = closed;
    if (closed) {
        const double volume = signed_volume_mm3(mesh);
        result["signed_volume_mm3"] = volume;
        result["orientation"] = volume < 0.0 ? "inward" : "outward";
    }
    return result;
}

Json describe_centreline(const CentrelineGraph& graph) {
    std::vector<int> degree(graph.nodes.size(), 0);
    double length = 0.0;
    for (const CentrelineGraph::Edge& edge : graph.edges) {
        ++degree[edge.a];
        ++degree[edge.b];
        length += glm::length(graph.nodes[edge.a].position_mm - graph.nodes[edge.b].position_mm);
    }
    Json result = {{"nodes", graph.nodes.size()},
                   {"edges", graph.edges.size()},
                   {"ends", std::ranges::count(degree, 1)},
                   {"branchings", std::ranges::count_if(degree, [](int d) { return d > 2; })},
                   {"isolated_nodes", std::ranges::count(degree, 0)},
                   {"length_mm", length}};
    if (!graph.nodes.empty()) {
        const auto [low, high] =
            std::ranges::minmax_element(graph.nodes, {}, &CentrelineGraph::Node::radius_mm);
        result["radius_mm"] = {{"min", low->radius_mm}, {"max", high->radius_mm}};
    }
    return result;
}

/// Finite range, NaN and Inf of each channel.
Json describe_channels(const Image& image, const std::vector<std::string>& names) {
    Json channels = Json::array();
    const std::vector<float> values = to_floats(image);
    const std::size_t step = names.size();
    for (std::size_t c = 0; c < step; ++c) {
        float low = std::numeric_limits<float>::max();
        float high = std::numeric_limits<float>::lowest();
        std::uint64_t nan = 0;
        std::uint64_t inf = 0;
        for (std::size_t i = c; i < values.size(); i += step) {
            if (std::isnan(values[i])) {
                ++nan;
            } else if (std::isinf(values[i])) {
                ++inf;
            } else {
                low = std::min(low, values[i]);
                high = std::max(high, values[i]);
            }
        }
        Json entry = {{"name", names[c]}, {"nan", nan}, {"inf", inf}};
        if (low <= high) {
            entry["min"] = low;
            entry["max"] = high;
        }
        channels.push_back(std::move(entry));
    }
    return channels;
}

Json describe_part(const ExrPart& part) {
    Json attributes = Json::object();
    for (const ExrAttribute& attribute : part.attributes) {
        std::visit([&](const auto& value) { attributes[attribute.name] = value; }, attribute.value);
    }
    Json result = {{"name", part.name},
                   {"width", part.image.width},
                   {"height", part.image.height},
                   {"format", info(part.image.format).name},
                   {"channels", describe_channels(part.image, part.channels)},
                   {"attributes", std::move(attributes)}};
    if (!part.compression.empty()) {
        result["compression"] = part.compression;
    }
    return result;
}

Json describe_images(const std::filesystem::path& file) {
    Json images = Json::array();
    if (lower_extension(file) == ".exr") {
        for (const ExrPart& part : read_exr(file)) {
            images.push_back(describe_part(part));
        }
        return images;
    }
    ExrPart part{"", read_image(file), {}, {}, ""};
    part.channels = default_channel_names(part.image.format);
    images.push_back(describe_part(part));
    return images;
}

bool has_lines(const std::filesystem::path& file) {
    return std::ranges::any_of(read_vtp(file),
                               [](const VtpPiece& piece) { return !piece.lines.offsets.empty(); });
}

/// Finite range, mean and histogram of a channel, rescaled.
Json describe_values(const VolumeStatistics& values) {
    Json result = {{"non_finite", values.non_finite}};
    if (std::ranges::any_of(values.histogram, [](std::size_t count) { return count > 0; })) {
        result["min"] = values.min;
        result["max"] = values.max;
        result["mean"] = values.mean;
        result["histogram"] = values.histogram;
    }
    return result;
}

/// Extents as files and scenes give them: degrees and mm.
Json describe_shape(const VolumeShape& shape) {
    Json result = {{"kind", to_string(shape.kind)},
                   {"r_min_mm", shape.r_min_mm},
                   {"r_max_mm", shape.r_max_mm},
                   {"first_angle_deg", glm::degrees(shape.first_angle_rad)},
                   {"angle_deg", glm::degrees(shape.angle_rad)},
                   {"wrap", shape.wrap}};
    if (shape.kind == VolumeKind::cylindrical) {
        result["height_mm"] = shape.height_mm;
    } else {
        result["latitude_deg"] = glm::degrees(shape.latitude_rad);
    }
    return result;
}

Json describe_volume(const std::filesystem::path& file, Log& log) {
    constexpr int bins = 32;
    const Volume volume = load_volume(file, {}, log);
    const VolumeGrid& grid = volume.grid;
    Json direction = Json::array();
    for (int row = 0; row < 3; ++row) {
        direction.push_back({grid.direction[0][row], grid.direction[1][row], grid.direction[2][row]});
    }
    Json channels = Json::array();
    for (int channel = 0; channel < volume.channels; ++channel) {
        channels.push_back(describe_values(statistics(volume, channel, bins)));
    }
    Json result = {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
                   {"spacing_mm", numbers_json(grid.spacing_mm)},
                   {"origin_mm", numbers_json(grid.origin_mm)},
                   {"direction", std::move(direction)},
                   {"type", to_string(volume.type)},
                   {"slope", volume.slope},
                   {"intercept", volume.intercept},
                   {"unit", volume.unit},
                   {"channels", std::move(channels)}};
    if (grid.curvilinear()) {
        result["geometry"] = describe_shape(grid.shape);
    }
    if (volume.narrowing_error > 0.0) {
        result["narrowing_error"] = volume.narrowing_error;
    }
    return result;
}

[[noreturn]] void fail_unknown(const std::filesystem::path& file) {
    static const std::map<std::string_view, std::string_view> advice{
        {".vtk",
         "of .vtk only structured points are read; save surfaces as .vtp or .ply, for example with ParaView"},
        {".vtu", "extract the surface and save it as .vtp, for example with ParaView"},
        {".fbx", "export it as .glb, for example with Blender"},
        {".dae", "export it as .glb, for example with Blender"},
        {".blend", "export it as .glb from Blender"},
        {".3ds", "export it as .glb, for example with Blender"},
        {".3mf", "export it as .stl or .ply, for example with Blender or a slicer"},
        {".step", "mesh it and save it as .stl, for example with FreeCAD"},
        {".stp", "mesh it and save it as .stl, for example with FreeCAD"},
        {".off", "save it as .ply, for example with MeshLab"},
        {".tif",
         "convert it with ImageMagick to .png or with oiiotool to .exr; a folder of slices is a volume"},
        {".tiff", "convert it with ImageMagick to .png or with oiiotool to .exr"},
        {".bmp", "convert it with ImageMagick to .png"},
        {".hdr", "convert it with oiiotool to .exr"}};
    std::string message =
        "cannot be described: meshes are read from .gltf, .glb, .stl, .obj, .ply and .vtp, centrelines from "
        ".vtp and .json, pictures from .exr, .png, .jpg, volumes from DICOM, .nii, .nrrd, .mha, .mhd, .vtk, "
        ".vti, .csv, .plist (InVesalius), folders of slices, and .json beside a raw file";
    if (const auto found = advice.find(lower_extension(file)); found != advice.end()) {
        message += "; " + std::string(found->second);
    } else {
        message += "; assimp, Blender or MeshLab convert other meshes, ImageMagick other pictures";
    }
    throw Error(ErrorCode::file, file.string(), message);
}

/// Whether a JSON file is meant as a scene.
bool is_scene(const std::filesystem::path& file) {
    const Json root = Json::parse(read_file(file), nullptr, false);
    return root.is_object() && root.contains("passes");
}

Json describe_geometry(const std::filesystem::path& file, Log& log) {
    const std::string extension = lower_extension(file);
    if (extension == ".json" && is_scene(file)) {
        throw Error(ErrorCode::file, file.string(), "is a scene: `viscera check` says what it draws");
    }
    Json result = Json::object();
    if (extension == ".json" || (extension == ".vtp" && has_lines(file))) {
        result["kind"] = "centreline";
        result["centrelines"] = Json::array({describe_centreline(load_centreline(file, log))});
        return result;
    }
    result["kind"] = "meshes";
    result["meshes"] = Json::array();
    for (const MeshData& mesh : load_meshes(file, {}, log)) {
        result["meshes"].push_back(describe_mesh(mesh));
    }
    return result;
}

}  // namespace

Json describe(const std::filesystem::path& file, const LogCallback& tell) {
    constexpr std::array images{".exr", ".png", ".jpg", ".jpeg"};
    constexpr std::array geometry{".gltf", ".glb", ".stl", ".obj", ".ply", ".vtp", ".json"};
    const std::string extension = lower_extension(file);
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        throw Error(ErrorCode::file, file.string(), "does not exist");
    }
    Json result;
    Log log(tell);
    const auto add_faults = [&] {
        result["faults"] = Json::object();
        for (const auto& [key, count] : log.faults()) {
            result["faults"][key] = count;
        }
    };
    if (is_volume(file)) {
        result = {{"kind", "volume"}, {"volume", describe_volume(file, log)}};
        add_faults();
    } else if (std::ranges::find(images, extension) != images.end()) {
        result = {{"kind", "image"}, {"images", describe_images(file)}};
    } else if (std::ranges::find(geometry, extension) != geometry.end()) {
        result = describe_geometry(file, log);
        add_faults();
    } else {
        fail_unknown(file);
    }
    result["file"] = file.string();
    return result;
}

}  // namespace viscera::io
