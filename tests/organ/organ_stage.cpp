#include "tests/organ/organ_stage.h"

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "engine/io/exr.h"

namespace viscera::test {

using nlohmann::json;

std::string patch_obj(const PatchOptions& o) {
    std::ostringstream obj;
    obj.precision(9);
    const double turn = o.uv_turn_deg * std::numbers::pi / 180.0;
    for (int j = 0; j <= o.cells; ++j) {
        for (int i = 0; i <= o.cells; ++i) {
            const double s = static_cast<double>(i) / o.cells;
            const double t = static_cast<double>(j) / o.cells;
            const double x = (s - 0.5) * o.size_mm;
            const double z = (t - 0.5) * o.size_mm;
            const double k = std::numbers::pi / o.size_mm;
            // Nearest to the viewer, who looks along +y, in the middle.
            obj << "v " << x << ' ' << -o.bend_mm * std::cos(k * x) * std::cos(k * z) << ' ' << z << '\n';
            const glm::dvec3 normal(-o.bend_mm * k * std::sin(k * x) * std::cos(k * z) * -1.0, -1.0,
                                    o.bend_mm * k * std::cos(k * x) * std::sin(k * z));
            const glm::dvec3 n = glm::normalize(normal);
            obj << "vn " << n.x << ' ' << n.y << ' ' << n.z << '\n';
            const double a = (o.mirrored_uv ? -1.0 : 1.0) * (s - 0.5) * o.uv_scale * o.uv_stretch;
            const double b = (t - 0.5) * o.uv_scale;
            obj << "vt " << 0.5 + std::cos(turn) * a - std::sin(turn) * b << ' '
                << 0.5 + std::sin(turn) * a + std::cos(turn) * b << '\n';
        }
    }
    const auto corner = [&](int i, int j) {
        const std::string n = std::to_string(j * (o.cells + 1) + i + 1);
        return ' ' + n + '/' + n + '/' + n;
    };
    for (int j = 0; j < o.cells; ++j) {
        for (int i = 0; i < o.cells; ++i) {
            obj << 'f' << corner(i, j) << corner(i + 1, j) << corner(i + 1, j + 1) << '\n'
                << 'f' << corner(i, j) << corner(i + 1, j + 1) << corner(i, j + 1) << '\n';
        }
    }
    return obj.str();
}

OrganStage::OrganStage(int w, int h)
    : parameters(
          {{"shading", {{"ambient", 0.1}, {"diffuse", 0.7}, {"specular", 0.3}, {"shininess", 20}}},
           {"lights",
            {{{"position", {6, 9, 3}}, {"colour", {0.9, 0.8, 0.7}}, {"falloff_mm", 260}, {"angular", 2}}}}}),
      camera({{"kind", "perspective"},
              {"eye_mm", {14, -92, 23}},
              {"target_mm", {0, 0, 0}},
              {"vertical_fov_deg", 34},
              {"near_mm", 5},
              {"far_mm", 400}}),
      width(w),
      height(h) {
    organ.ambient = 0.1;
    organ.diffuse_share = 0.7;
    organ.specular = 0.3;
    organ.specular_colour = {1.0, 0.97, 0.93};
    organ.shininess = 20.0;
    organ.lights = {{.place = {6, 9, 3}, .colour = {0.9, 0.8, 0.7}, .falloff_mm = 260, .angular = 2}};
    organ.colour = {0.44, 0.13, 0.1};
    use_mesh(patch_obj({}));
}

void OrganStage::use_mesh(const std::string& obj) {
    mesh_file_ = folder.write("mesh" + std::to_string(std::hash<std::string>()(obj)) + ".obj", obj).string();
    parameters["mesh"]["file"] = mesh_file_;
}

Image OrganStage::picture(int size, const std::function<float(double u, double v, int c)>& f) {
    Image image = make_image(size, size, PixelFormat::rgba32f);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            for (int c = 0; c < 4; ++c) {
                image.set(x, y, c, f((x + 0.5) / size, (y + 0.5) / size, c));
            }
        }
    }
    return image;
}

std::string OrganStage::picture_file(const std::string& name, int size,
                                     const std::function<float(double u, double v, int c)>& f) {
    const std::array<io::ExrPart, 1> parts{io::ExrPart{.name = "picture", .image = picture(size, f)}};
    io::write_exr(folder / name, parts, io::ExrCompression::none);
    return (folder / name).string();
}

void OrganStage::target(const std::string& name, int size,
                        const std::function<float(double u, double v, int c)>& f) {
    filled_.push_back({name, picture_file(name + ".exr", size, f), size});
}

json OrganStage::scene() const {
    json passes = json::array();
    json targets = json::object();
    for (const Filled& filled : filled_) {
        passes.push_back(pass("fill-" + filled.target, "picture.image",
                              {{"file", filled.file}, {"fit", "stretch"}, {"monochrome", false}},
                              {{"image", filled.target}}));
        targets[filled.target] = {{"format", "rgba32f"}, {"size", {filled.size, filled.size}}};
    }
    json bound = json::object();
    for (const Filled& filled : filled_) {
        const std::string port = filled.target.substr(filled.target.rfind('.') + 1);
        if (port == "diffuse" || port == "cut" || port == "hint") {
            bound[port] = filled.target;
        }
    }
    passes.push_back(pass("organ", "organ.surface", parameters, bound));
    targets["organ.color"] = {{"format", "rgba32f"}};
    json scene = scene_of(camera, passes, {"organ.color"}, width, height);
    scene["targets"] = targets;
    return scene;
}

Image OrganStage::render(double time_s, const HostValues* values) {
    stage_.load(scene());
    std::vector<std::string> kept{"organ.color"};
    for (const Filled& filled : filled_) {
        kept.push_back(filled.target);
    }
    stage_.renderer().keep(kept);
    Frame frame = stage_.renderer().still(time_s);
    frame.values = values;
    slant(frame);
    report_ = stage_.renderer().render(frame);
    return stage_.renderer().read("organ.color");
}

void OrganStage::slant(Frame& frame) const {
    frame.eyes[0].projection[2][0] += organ.slant * frame.eyes[0].projection[0][0];
}

reference::OrganMap OrganStage::read_target(const std::string& name) {
    return {.picture = to_buffer(stage_.renderer().read(name))};
}

void OrganStage::place(const MeshData& mesh) {
    const json& given = parameters["mesh"];
    if (!given.contains("placement")) {
        return;
    }
    const auto vector = [&](const char* name, const glm::dvec3& otherwise) {
        const json& placement = given["placement"];
        return placement.contains(name)
                   ? glm::dvec3(placement[name][0], placement[name][1], placement[name][2])
                   : otherwise;
    };
    const Bounds box = mesh.bounds();
    const glm::dvec3 centre = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
    const glm::dvec3 turn = glm::radians(vector("rotate_deg", glm::dvec3(0.0)));
    glm::dmat3 matrix(1.0);
    for (int axis = 2; axis >= 0; --axis) {
        glm::dmat3 about(1.0);
        const int a = (axis + 1) % 3;
        const int b = (axis + 2) % 3;
        about[a][a] = about[b][b] = std::cos(turn[axis]);
        about[a][b] = std::sin(turn[axis]);
        about[b][a] = -std::sin(turn[axis]);
        matrix = matrix * about;
    }
    const glm::dvec3 scale = vector("scale", glm::dvec3(1.0));
    for (int axis = 0; axis < 3; ++axis) {
        matrix[axis] *= scale[axis];
    }
    const glm::dmat3 covector = glm::transpose(glm::inverse(matrix));
    for (std::size_t v = 0; v < organ.positions.size(); ++v) {
        organ.positions[v] =
            centre + vector("move_mm", glm::dvec3(0.0)) + matrix * (organ.positions[v] - centre);
        organ.normals[v] = covector * organ.normals[v];  // as mixed in the mesh, then turned
    }
    if (glm::determinant(matrix) < 0.0) {  // the outside stays the outside
        for (std::size_t t = 0; t + 2 < organ.indices.size(); t += 3) {
            std::swap(organ.indices[t + 1], organ.indices[t + 2]);
        }
    }
}

reference::Buffer OrganStage::expected() {
    Log log;
    const MeshData mesh = io::merge(io::load_meshes(mesh_file_, {}, log));
    organ.positions.assign(mesh.positions.begin(), mesh.positions.end());
    organ.normals.assign(mesh.normals.begin(), mesh.normals.end());
    organ.uvs.assign(mesh.uvs.begin(), mesh.uvs.end());
    organ.indices = mesh.indices;
    place(mesh);
    Frame frame = stage_.renderer().still(0.0);
    slant(frame);
    organ.view = frame.eye().view;
    organ.projection = frame.eye().projection;
    organ.orthographic = frame.eye().orthographic;
    const double beyond = organ.focus ? reference::stored_blurriness(*organ.focus, 1e9) : 0.5;
    return reference::organ_picture(organ, width, height, {0.0, 0.0, 0.0, beyond});
}

}  // namespace viscera::test
