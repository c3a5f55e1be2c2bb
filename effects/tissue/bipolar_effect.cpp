#include "effects/tissue/bipolar_effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <glm/gtc/type_ptr.hpp>

#include "effects/tissue/list_texture.h"
#include "engine/core/error.h"
#include "engine/core/finite.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr std::array<std::string_view, 4> shape_names{"capsule", "box", "sphere", "cylinder"};
constexpr std::array<std::string_view, 4> shape_defines{"CAPSULE", "BOX", "SPHERE", "CYLINDER"};

/// Of a ball around the shape's centre in its own frame [mm].
double radius_of(const ToolParams& tool) {
    const glm::dvec3& size = tool.size_mm;
    switch (tool.shape) {
        case ToolShape::capsule:
            return 0.5 * size.x + size.z;
        case ToolShape::box:
            return 0.5 * glm::length(size);
        case ToolShape::sphere:
            return size.z;
        case ToolShape::cylinder:
            return std::hypot(0.5 * size.x, size.z);
    }
    return 0.0;
}

/// A coarse mesh may have no triangle that is short enough: who holds it would see nothing and not know why.
void say_all_connect(Log& log, const HoldResult& hold, double max_uv_perimeter) {
    std::array<char, 256> text{
        "none of the held triangles is burnt: they join parts that lie apart in the texture"};
    if (static_cast<double>(hold.shortest_uv_perimeter) > max_uv_perimeter) {
        std::snprintf(
            text.data(), text.size(),
            "none of the held triangles is burnt: the shortest has a perimeter of %.3g in the texture, "
            "and 'max_uv_perimeter' is %.3g",
            static_cast<double>(hold.shortest_uv_perimeter), max_uv_perimeter);
    }
    log.fault("tissue.held_connect", text.data(), hold.connecting);
}

}  // namespace

/// What the shader reads.
struct BipolarEffect::Gpu {
    std::optional<gl::Texture> triangles;  ///< by texel: 1 + its triangle, 0 none
    std::shared_ptr<const TexelMap> triangles_of;
    ListTexture held;
    std::vector<glm::vec4> flags;
};

std::span<const std::string_view> choice_names(ToolShape) {
    return shape_names;
}

void ToolParams::visit(ParamVisitor& v) {
    v.field({.name = "shape", .doc = "What is burnt lies within it."}, shape);
    v.field(
        {.name = "size_mm",
         .doc = "Capsule, cylinder: length along its x axis, unused, radius. Sphere: unused, unused, radius. "
                "Box: its sides.",
         .unit = "mm",
         .min = 0.0},
        size_mm);
    v.field({.name = "placement", .doc = "Where it is, unless the host says so by `tissue.tool`."},
            placement);
}

void BipolarParams::visit(ParamVisitor& v) {
    v.field({.name = "mesh", .doc = "The mesh of the bake.", .required = true}, mesh);
    visit_size(v, size);
    v.field({.name = "held",
             .doc = "Vertices that the tool holds, unless the host says so by `tissue.held`.",
             .min = 0.0},
            held);
    v.field({.name = "tool", .doc = "The space between its jaws."}, tool);
    v.field({.name = "energy", .doc = "What burnt tissue has at least.", .min = 0.0, .max = 60000.0}, energy);
    v.field(
        {.name = "max_uv_perimeter",
         .doc = "Triangles with a longer one in the texture connect parts that lie apart, and are not held. "
                "Coarse meshes want more: where no held triangle is left, a fault names the shortest.",
         .min = 0.0},
        max_uv_perimeter);
}

BipolarEffect::BipolarEffect() {
    for (const std::string_view shape : shape_defines) {
        programs_.push_back({"common/fullscreen.vert", "tissue/bipolar.frag", {std::string(shape)}});
    }
}
BipolarEffect::~BipolarEffect() = default;

std::vector<Port> BipolarEffect::ports() const {
    return {{.name = "energy",
             .access = Access::write,
             .target = "tissue.energy",
             .doc = "Energy with what the tool adds.",
             .format = PixelFormat::r32f,
             .size = square(params_.size),
             .passthrough = "before",
             .overwrites = true},
            {.name = "before",
             .access = Access::read,
             .target = "tissue.energy",
             .doc = "Energy without it: tissue.coagulate, which keeps the state, comes before this."},
            read_bake("position")};
}

void BipolarEffect::find_surface(Prepare& prepare) {
    const int size = prepare.size("energy").x;
    if (!surface_ || surface_->size() != size || parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        surface_ = BakedSurface::load(prepare.assets(), params_.mesh, size);
        map_ = surface_->map(prepare.assets());
        const SurfaceMesh& mesh = surface_->mesh();
        triangles_ = std::make_unique<HeldTriangles>(texel_surface(mesh), mesh.merged_vertex_count(),
                                                     params_.max_uv_perimeter);
    }
    surface_->check_bake(prepare, "tissue.coagulate_bipolar");
    surface_->move(prepare);
}

std::span<const float> BipolarEffect::held_numbers(const HostValues* values) {
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find("tissue.held");
    if (given != nullptr) {
        return given->values;
    }
    held_.assign(params_.held.begin(), params_.held.end());
    return held_;
}

/// The tool's frame in the world. False: it has none.
bool BipolarEffect::find_tool(Prepare& prepare) {
    const HostValues* values = prepare.frame().values;
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find("tissue.tool");
    pose_ = placement_matrix(params_.tool.placement, glm::dvec3(0.0));
    if (given != nullptr && given->values.size() == 16) {
        pose_ = glm::dmat4(glm::make_mat4(given->values.data()));
    } else if (given != nullptr) {
        prepare.log().fault("tissue.tool", "host values 'tissue.tool' must be the 16 numbers of a matrix");
        return false;
    }
    if (!finite(pose_) || !invertible(pose_)) {
        prepare.log().fault("tissue.tool_pose",
                            "the pose of the bipolar tool is not finite or has no inverse");
        return false;
    }
    return true;
}

Work BipolarEffect::prepare(Prepare& prepare) {
    const std::span<const float> numbers = held_numbers(prepare.frame().values);
    if (numbers.empty()) {
        return Work::idle("nothing is held");
    }
    if (!prepare.has("position")) {
        return Work::idle("there is no surface");
    }
    check_size(prepare, "energy");
    if (!find_tool(prepare)) {
        return Work::idle("the tool is nowhere");
    }
    find_surface(prepare);
    const HoldResult hold = triangles_->hold(numbers);
    if (hold.useless > 0) {
        prepare.log().fault("tissue.held", "held vertices that the mesh does not have are left out",
                            hold.useless);
    }
    if (triangles_->count() == 0 && hold.connecting == 0) {
        return Work::idle("no triangle is held");
    }
    if (triangles_->count() == 0) {
        say_all_connect(prepare.log(), hold, params_.max_uv_perimeter);
        return Work::idle("all triangles that are held connect parts of the texture");
    }
    // A pose may stretch the tool: by no more than the lengths of its columns together.
    const double stretch =
        std::sqrt(glm::dot(pose_[0], pose_[0]) + glm::dot(pose_[1], pose_[1]) + glm::dot(pose_[2], pose_[2]));
    const glm::dvec3 centre(pose_[3]);
    TileTree& tiles = surface_->tiles(prepare.assets());
    found_.clear();
    tiles.near(centre, centre, stretch * radius_of(params_.tool), found_);
    PixelRegion region;
    constexpr int t = TileTree::tile_texels;
    for (const std::uint32_t tile : found_) {
        if (tiles.holds_any(tile, triangles_->held())) {
            const int side = tiles.tiles_per_side();
            region.add({static_cast<int>(tile) % side * t, static_cast<int>(tile) / side * t, t, t});
        }
    }
    if (region.empty()) {
        return Work::idle("what is held lies outside the tool");
    }
    return Work::update(region, "only what the tool holds", 0);
}

void BipolarEffect::draw(const Pass& pass) {
    if (!gpu_) {
        gpu_ = std::make_unique<Gpu>();
    }
    if (gpu_->triangles_of != map_) {
        gpu_->triangles_of = map_;
        std::vector<float> numbers;
        for (const TexelPoint& point : map_->texels) {
            const float triangle = point.triangle < 0.0F ? -point.triangle : point.triangle + 1.0F;
            numbers.push_back(point.owner == 0.0F ? 0.0F : triangle);
        }
        gpu_->triangles =
            gl::Texture::make_2d(pass.gl(), map_->size, map_->size, PixelFormat::r32f, "triangles of texels");
        gpu_->triangles->upload(std::as_bytes(std::span(numbers)));
    }
    const std::span<const char> held = triangles_->held();
    gpu_->flags.assign((held.size() + 3) / 4, glm::vec4(0.0F));
    for (std::size_t i = 0; i < held.size(); ++i) {
        gpu_->flags[i / 4][static_cast<int>(i % 4)] = held[i] != 0 ? 1.0F : 0.0F;
    }
    gpu_->held.upload(pass.gl(), gpu_->flags, "held triangles");
    const gl::Program& program = pass.use(static_cast<std::size_t>(params_.tool.shape));
    pass.bind(program, "u_before", "before");
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_triangles", *gpu_->triangles, gl::Filter::nearest);
    pass.bind(program, "u_held", gpu_->held.texture(), gl::Filter::nearest);
    program.set("u_to_tool", glm::mat4(glm::inverse(pose_)));
    program.set("u_size_mm", glm::vec3(params_.tool.size_mm));
    program.set("u_energy", static_cast<float>(params_.energy));
    program.set("u_size", static_cast<float>(pass.size().x));
    pass.draw_fullscreen();
}

}  // namespace viscera::tissue
