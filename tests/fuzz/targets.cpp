#include "tests/fuzz/targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/core/scene.h"
#include "engine/core/shader_source.h"
#include "engine/io/exr.h"
#include "engine/io/mesh.h"
#include "engine/io/png.h"
#include "engine/io/transfer_function.h"
#include "engine/io/volume.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"
#include "tests/io/volume_files.h"

namespace viscera::fuzz {
namespace {

void require(bool holds, const char* what) {
    if (!holds) {
        throw std::logic_error(what);
    }
}

/// Runs a reader on a file of these bytes. Error(file) and Error(limit) are its good right.
template <class Read>
void on_file(std::string_view name, std::string_view bytes, const Read& read) {
    static const test::TempFolder folder;
    const std::filesystem::path file = folder.write(name, bytes);
    try {
        read(file);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::file || error.code() == ErrorCode::limit, "error of a wrong kind");
        require(error.where().find(name) != std::string::npos, "error that does not name the file");
    }
}

void check_mesh(const MeshData& mesh) {
    const std::size_t vertices = mesh.positions.size();
    require(mesh.indices.size() % 3 == 0, "indices are no triangles");
    for (const std::uint32_t index : mesh.indices) {
        require(index < vertices, "index out of range");
    }
    for (const glm::vec3& p : mesh.positions) {
        require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "position not finite");
    }
    require(mesh.normals.empty() || mesh.normals.size() == vertices, "wrong number of normals");
    require(mesh.uvs.empty() || mesh.uvs.size() == vertices, "wrong number of texture coordinates");
    for (const VertexScalars& scalars : mesh.scalars) {
        require(scalars.values.size() == vertices, "wrong number of scalars");
    }
}

void read_mesh(const std::filesystem::path& file) {
    Log log;
    for (const MeshData& mesh : io::load_meshes(file, {}, log)) {
        check_mesh(mesh);
    }
}

void read_lines(const std::filesystem::path& file) {
    Log log;
    const CentrelineGraph graph = io::load_centreline(file, log);
    for (const CentrelineGraph::Edge& edge : graph.edges) {
        require(edge.a < graph.nodes.size() && edge.b < graph.nodes.size(), "edge out of range");
    }
}

void check_image(const Image& image) {
    require(image.width >= 0 && image.height >= 0, "negative size");
    require(image.data.size() == static_cast<std::size_t>(image.width) *
                                     static_cast<std::size_t>(image.height) * bytes_per_pixel(image.format),
            "bytes do not match the size");
}

void run_scene(std::string_view bytes) {
    try {
        const Scene scene = parse_scene(bytes, "scene.json");
        require(scene.width > 0 && scene.height > 0, "frame without pixels");
        require(std::isfinite(scene.time_s) && scene.frames_per_second > 0.0, "times that make no sense");
        require(!scene.outputs.empty(), "no outputs");
    } catch (const Error& error) {
        require(error.code() == ErrorCode::scene, "error of a wrong kind");
    }
}

void run_gltf(std::string_view bytes) {
    on_file("fuzz.glb", bytes, read_mesh);
}
void run_vtp(std::string_view bytes) {
    on_file("fuzz.vtp", bytes, read_mesh);
    on_file("fuzz.vtp", bytes, read_lines);
}
void run_ply(std::string_view bytes) {
    on_file("fuzz.ply", bytes, read_mesh);
}
void run_obj(std::string_view bytes) {
    on_file("fuzz.obj", bytes, read_mesh);
}
void run_stl(std::string_view bytes) {
    on_file("fuzz.stl", bytes, read_mesh);
}
void run_centreline(std::string_view bytes) {
    on_file("fuzz.json", bytes, read_lines);
}
void run_exr(std::string_view bytes) {
    on_file("fuzz.exr", bytes, [](const std::filesystem::path& file) {
        for (const io::ExrPart& part : io::read_exr(file)) {
            check_image(part.image);
        }
    });
}
void run_png(std::string_view bytes) {
    on_file("fuzz.png", bytes, [](const std::filesystem::path& file) { check_image(io::read_image(file)); });
}

void check_transfer_function(const TransferFunction& function) {
    std::size_t faults = 0;
    require(normalised(function, faults) == function && faults == 0, "transfer function not normalised");
    require(!function.points.empty(), "transfer function without points");
}

void read_functions(const std::filesystem::path& file) {
    Log log;
    const std::vector<TransferFunction> functions = io::load_transfer_functions(file, log);
    require(!functions.empty(), "no transfer function");
    for (const TransferFunction& function : functions) {
        check_transfer_function(function);
    }
}

void run_transfer_function(std::string_view bytes) {
    on_file("fuzz.vp", bytes, read_functions);
    on_file("fuzz.json", bytes, read_functions);
}

/// The files a, b, c, ..., one after another with a zero byte between; the driver's log is the last of them.
void run_shader(std::string_view bytes) {
    std::vector<std::string> files(1);
    for (const char c : bytes) {
        if (c == '\0') {
            files.emplace_back();
        } else {
            files.back() += c;
        }
    }
    const ShaderReader reader = [&](std::string_view name) -> std::optional<std::string> {
        const std::size_t index = name.size() == 1 ? static_cast<std::size_t>(name[0]) - 'a' : files.size();
        return index < files.size() ? std::optional(files[index]) : std::nullopt;
    };
    try {
        const ShaderSource source = expand_shader("a", std::vector<std::string>{"NAME", "OTHER 3"}, reader);
        const auto lines = static_cast<std::size_t>(std::count(source.text.begin(), source.text.end(), '\n'));
        require(source.lines.size() >= lines, "a line without its place");
        for (const SourceLine& line : source.lines) {
            require(line.file == ShaderSource::npos || line.file < source.files.size(), "a place in no file");
        }
        (void)map_shader_log(files.back(), source);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::gl, "error of a wrong kind");
    }
}

/// The first byte chooses the format; the rest is the file.
void run_volume(std::string_view bytes) {
    static constexpr std::array names{"fuzz.mha",   "fuzz.nrrd", "fuzz.nii", "fuzz.nii.gz",
                                      "fuzz.vtk",   "fuzz.vti",  "fuzz.csv", "fuzz.json",
                                      "fuzz.plist", "fuzz.dcm",  "fuzz.dcm", "fuzz.dcm"};
    if (bytes.empty()) {
        return;
    }
    const auto which = static_cast<std::size_t>(static_cast<unsigned char>(bytes[0]));
    on_file(names.at(which % names.size()), bytes.substr(1), [](const std::filesystem::path& file) {
        constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20U;
        Log log;
        const Volume volume = io::load_volume(file, {.memory_limit = most_bytes}, log);
        volume.validate();
        const VolumeStatistics values = statistics(volume);
        require(std::isfinite(values.min) && std::isfinite(values.max), "range that is not finite");
        reduced(volume, 2).validate();
    });
}

std::vector<std::string> scene_seeds() {
    return {R"({"version":1,"name":"a","resolution":[64,48],"time_s":1.5,"frames_per_second":15,
        "camera":{"kind":"c_arm","primary_deg":-30},"shared":{"s":{"a":1}},
        "passes":[{"name":"p","effect":"e","parameters":{"$ref":"#/shared/s","b":[1,2]},"targets":{"main":"x"}}],
        "targets":{"x":{"format":"r16f","scale":0.5,"clear":[1]}},"outputs":["x"]})"};
}
std::vector<std::string> gltf_seeds() {
    return {test::tetra_glb(), test::tetra_json(R"(,"uri":"data:application/octet-stream;base64,)" +
                                                test::base64(test::tetra_binary()) + "\"")};
}
std::vector<std::string> vtp_seeds() {
    return {
        test::tetra_vtp(),
        test::vtp(R"(NumberOfPoints="3" NumberOfLines="1")",
                  R"(<PointData><DataArray type="Float64" Name="radius" format="ascii">1 2 3</DataArray>)"
                  R"(</PointData><Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">)"
                  "0 0 0 0 0 1 0 0 2</DataArray></Points><Lines>"
                  R"(<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>)"
                  R"(<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray></Lines>)")};
}
std::vector<std::string> ply_seeds() {
    return {test::tetra_ply(), test::tetra_ply_binary()};
}
std::vector<std::string> obj_seeds() {
    return {test::tetra_obj(),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a\nf 1/1/1 2/1/1 3//1\nf -1 -2 -3\n"};
}
std::vector<std::string> stl_seeds() {
    return {test::tetra_stl(), test::tetra_stl_text(), test::tetra_stl_text() + test::tetra_stl_text()};
}
std::vector<std::string> centreline_seeds() {
    return {R"({"unit":"mm","nodes":[[0,0,0,1],[0,0,9,2],[1,2,3,4]],"edges":[[0,1],[1,2]]})"};
}

/// Each reader of the target meets the seeds of the other too, and may refuse them.
std::vector<std::string> transfer_function_seeds() {
    return {"1\n0\n0.8\n0.2\n0.3\n9\n4 -5 0 5 0.5\n4 0 0.5 9 1\n8 -5 0 0 1 5 1 0 0\n",
            R"([{"Name":"a","ColorSpace":"Diverging","NanColor":[1,0,0],"RGBPoints":[0,0,0,1,1,1,0,0],)"
            R"("Points":[0,0.2,0.3,0.4,1,0.9,0.5,0]}])",
            R"({"volumeProperties":[{"interpolationType":"linear","components":[{"shade":true,)"
            R"("scalarOpacityUnitDistance":2,"lighting":{"ambient":0.1},)"
            R"("scalarOpacity":{"points":[{"x":0,"y":0,"midpoint":0.4,"sharpness":0.7},{"x":9,"y":1}]},)"
            R"("gradientOpacity":{"points":[{"x":0,"y":0.5}]},)"
            R"("rgbTransferFunction":{"points":[{"x":0,"color":[0,0.5,1]}]}}]}]})",
            R"({"name":"b","technique":"mip","shaded":true,"lighting":{"diffuse":0.5},)"
            R"("reference_length_mm":2,"points":[{"value":1,"colour":[1,0,0],"opacity":0.5}]})"};
}

std::string picture(const char* name, io::ExrCompression compression, int parts) {
    const test::TempFolder folder;
    Image image = make_image(9, 6, PixelFormat::rgba16f);
    for (int i = 0; i < 54; ++i) {
        image.set(i % 9, i / 9, i % 4, static_cast<float>(i) / 54.0F);
    }
    const std::filesystem::path file = folder / name;
    if (file.extension() == ".png") {
        io::write_png(file, image);
    } else {
        std::vector<io::ExrPart> all;
        for (int i = 0; i < parts; ++i) {
            all.push_back({.name = "part" + std::to_string(i), .image = image});
        }
        io::write_exr(file, all, compression);
    }
    return test::slurp(file);
}
std::vector<std::string> exr_seeds() {
    return {picture("a.exr", io::ExrCompression::none, 1), picture("a.exr", io::ExrCompression::zip, 2),
            picture("a.exr", io::ExrCompression::piz, 1), picture("a.exr", io::ExrCompression::dwaa, 1)};
}
std::vector<std::string> png_seeds() {
    return {picture("a.png", io::ExrCompression::none, 1)};
}
std::vector<std::string> shader_seeds() {
    std::string seed =
        "#version 330 core\n#include \"b\"\n// c\nvoid main() {\n#ifdef NAME\n#include \"c\"\n#endif\n}\n";
    seed += '\0';
    seed += "#include \"c\"\nfloat f() { return 1.0; }\n";
    seed += '\0';
    seed += "0:12(5): error: x\n0(3) : error C1\nERROR: 0:2: y\n";
    return {seed};
}

std::vector<std::string> volume_seeds() {
    const std::string shorts = test::bytes_of(test::ramp<std::int16_t>());
    const std::string nifti = test::Nifti(4, 16).bytes + shorts;
    const std::string array = R"(<DataArray type="Int16" Name="density" format=)";
    const std::array files{test::mha("MET_SHORT", shorts),
                           test::nrrd("short", "gzip", test::deflated(shorts, 31)),
                           nifti,
                           test::deflated(nifti, 31),
                           test::legacy_vtk("BINARY", "short", shorts),
                           test::vti(array + "\"ascii\">" + test::ramp_text<int>() + "</DataArray>"),
                           test::csv(),
                           std::string(R"({"file":"none.raw","dims":[4,3,2],"type":"i16","axes":"RAS"})"),
                           std::string("<plist><dict><key>matrix</key><dict><key>dtype</key><string>int16</"
                                       "string></dict></dict></plist>"),
                           test::dicom({}),
                           test::dicom({.coding = test::DicomCoding::big}),
                           test::dicom({.coding = test::DicomCoding::deflated})};
    std::vector<std::string> seeds;
    for (std::size_t i = 0; i < files.size(); ++i) {
        seeds.push_back(static_cast<char>(i) + files.at(i));
    }
    return seeds;
}

constexpr std::array<Target, 12> all{{{"scene", run_scene, scene_seeds},
                                      {"gltf", run_gltf, gltf_seeds},
                                      {"vtp", run_vtp, vtp_seeds},
                                      {"ply", run_ply, ply_seeds},
                                      {"obj", run_obj, obj_seeds},
                                      {"stl", run_stl, stl_seeds},
                                      {"centreline", run_centreline, centreline_seeds},
                                      {"exr", run_exr, exr_seeds},
                                      {"png", run_png, png_seeds},
                                      {"transfer_function", run_transfer_function, transfer_function_seeds},
                                      {"shader", run_shader, shader_seeds},
                                      {"volume", run_volume, volume_seeds}}};

}  // namespace

std::span<const Target> targets() {
    return all;
}

}  // namespace viscera::fuzz
