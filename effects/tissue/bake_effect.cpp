#include "effects/tissue/bake_effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

/// Rows of the textures that hold vertices and triangles.
constexpr std::size_t row_length = 1024;

/// Outputs besides positions, each compiled in where somebody reads it.
struct Feature {
    std::string_view port;
    std::string_view define;
};
constexpr std::array<Feature, 3> features{{{"normal", "NORMAL"}, {"metric", "METRIC"}, {"seam", "SEAM"}}};

// Beyond this a float cannot count triangles or vertices.
constexpr std::size_t most_counted = std::size_t{1} << 24U;

std::size_t rows_for(std::size_t count) {
    return std::max<std::size_t>((count + row_length - 1) / row_length, 1);
}

}  // namespace

/// What the shader reads.
struct BakeEffect::Gpu {
    std::optional<gl::Texture> vertices;
    std::optional<gl::Texture> triangles;
    std::optional<gl::Texture> map;
    std::shared_ptr<const TexelMap> map_of;
    std::uint64_t mesh_key = 0;
    std::uint64_t content_key = 0;
};

void BakeParams::visit(ParamVisitor& v) {
    v.field({.name = "mesh", .doc = "The surface.", .required = true}, mesh);
    visit_size(v, size);
}

BakeEffect::BakeEffect() {
    for (std::uint32_t wanted = 0; wanted < 1U << features.size(); ++wanted) {
        ProgramDesc program{"common/fullscreen.vert", "tissue/bake.frag", {}};
        for (std::size_t i = 0; i < features.size(); ++i) {
            if ((wanted >> i & 1U) != 0) {
                program.defines.emplace_back(features[i].define);
            }
        }
        programs_.push_back(std::move(program));
    }
}
BakeEffect::~BakeEffect() = default;

std::vector<Port> BakeEffect::ports() const {
    const SizeRule size = square(params_.size);
    return {{.name = "position",
             .access = Access::write,
             .target = "tissue.position",
             .doc = "Place in the world [mm]; alpha 1 inside a chart, 0.5 in its gutter, 0 where nothing is.",
             .format = PixelFormat::rgba32f,
             .size = size,
             .overwrites = true},
            {.name = "normal",
             .access = Access::write,
             .target = "tissue.normal",
             .doc = "Unit normal in the world, and alpha as position has it.",
             .format = PixelFormat::rgba16f,
             .size = size,
             .optional = true,
             .overwrites = true},
            {.name = "metric",
             .access = Access::write,
             .target = "tissue.metric",
             .doc = "Length of a texel step in u and in v [mm], the cosine between them, and a texel's area "
                    "[mm^2].",
             .format = PixelFormat::rgba32f,
             .size = size,
             .optional = true,
             .overwrites = true},
            {.name = "seam",
             .access = Access::write,
             .target = "tissue.seam",
             .doc = "A texel's own UV inside charts; in gutters the UV where the surface goes on; (-1, -1) "
                    "where it does not.",
             .format = PixelFormat::rg32f,
             .size = size,
             .clear = {-1.0F, -1.0F, 0.0F, 0.0F},
             .optional = true,
             .overwrites = true}};
}

Work BakeEffect::prepare(Prepare& prepare) {
    const glm::ivec2 size = prepare.size("position");
    if (!surface_ || surface_->size() != size.x || parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        surface_ = BakedSurface::load(prepare.assets(), params_.mesh, size.x);
        baker_ = std::make_shared<const int>(0);
        map_.reset();
    }
    surface_->set_baker(baker_);
    surface_->move(prepare);
    if (surface_->mesh().data().indices.empty()) {
        return Work::idle("the mesh has no triangles");
    }
    if (!invertible(surface_->to_world())) {
        prepare.log().fault("tissue.singular", "the mesh's placement is singular; nothing is baked");
        return Work::idle("the mesh's placement is singular");
    }
    if (size.x != size.y) {
        prepare.log().fault("tissue.no_square", "a bake's targets are no squares; nothing is baked");
        return Work::idle("its targets are no squares");
    }
    if (!map_) {
        find_map(prepare);
    }
    count_collapsed(prepare.log());
    wanted_ = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
        wanted_ |= (prepare.has(features[i].port) ? 1U : 0U) << i;
    }
    content_key_ = Hash().add(parameters_key_).add(surface_->mesh().shape_key()).value();
    Work work = Work::all(content_key_);
    work.subject = surface_->mesh().key();
    return work;
}

/// From what other passes or an earlier run have found, or anew.
void BakeEffect::find_map(Prepare& prepare) {
    const std::string file = params_.mesh.file.path.string();
    const MeshData& mesh = surface_->mesh().data();
    if (mesh.triangle_count() >= most_counted || mesh.positions.size() >= most_counted) {
        throw Error(ErrorCode::limit, file, "has more triangles or vertices than can be baked (16,777,216)");
    }
    map_ = surface_->map(prepare.assets());
    const auto say = [&](std::string_view key, std::uint64_t count, const std::string& what) {
        if (count > 0) {
            prepare.log().fault(key, file + ": " + std::to_string(count) + " " + what, count);
        }
    };
    const TexelMapFaults& faults = map_->faults;
    say("tissue.overlap", faults.overlapping_texels,
        "texels lie in more than one triangle; the first one in the file has them");
    say("tissue.flat", faults.flat_triangles,
        "triangles have no area in the texture; nothing is painted on them");
    say("tissue.huge", faults.huge_triangles,
        "triangles span more than 4 textures; nothing is painted on them");
    say("tissue.non_manifold", faults.non_manifold_edges,
        "edges join more than two triangles; what is painted ends there");
    say("tissue.gutter", faults.narrow_texels,
        "texels lie within 4 texels of two charts, whose gutters are narrower than that at a 'size' of " +
            std::to_string(map_->size) + "; seams may show");
    if (faults.mirrored_triangles > 0) {
        prepare.log().info(file + ": " + std::to_string(faults.mirrored_triangles) + " of " +
                           std::to_string(mesh.triangle_count()) +
                           " triangles are mirrored in the texture; they are painted like others");
    }
}

/// Of triangles that a host has moved. The file's own without area are said and dropped when it is read.
void BakeEffect::count_collapsed(Log& log) {
    const std::uint64_t shape = surface_->mesh().shape_key();
    if (std::exchange(counted_shape_, shape) == shape || shape == surface_->mesh().key()) {
        return;
    }
    const MeshData& mesh = surface_->mesh().data();
    constexpr double thinnest = 1e-6;  // height over length
    std::uint64_t collapsed = 0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[t + k]]); };
        const glm::dvec3 a = corner(1) - corner(0);
        const glm::dvec3 b = corner(2) - corner(0);
        const double longest2 = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(b - a, b - a)});
        collapsed += glm::length(glm::cross(a, b)) > thinnest * longest2 ? 0 : 1;
    }
    if (collapsed > 0) {
        log.fault(
            "tissue.collapsed",
            params_.mesh.file.path.string() + ": " + std::to_string(collapsed) +
                " triangles have no area where the host has moved them; what is painted on them lies on "
                "a line",
            collapsed);
    }
}

void BakeEffect::fill_vertices() {
    const MeshData& mesh = surface_->mesh().data();
    const glm::dmat4& to_world = surface_->to_world();
    // A covector: turned by the inverse transpose, so that it stays on its side of a mirrored surface.
    const glm::dmat3 normal_to_world = glm::transpose(glm::inverse(glm::dmat3(to_world)));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 place(to_world * glm::dvec4(mesh.positions[v], 1.0));
        const glm::dvec3 normal = normal_to_world * glm::dvec3(mesh.normals[v]);
        const double length = glm::length(normal);
        vertices_[2 * v] = {place, mesh.uvs[v].x};
        vertices_[2 * v + 1] = {length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0F), mesh.uvs[v].y};
    }
}

/// Brings what the shader reads up to date.
void BakeEffect::upload(const Pass& pass) {
    if (!gpu_) {
        gpu_ = std::make_unique<Gpu>();
    }
    const MeshData& mesh = surface_->mesh().data();
    if (gpu_->mesh_key != surface_->mesh().key()) {
        gpu_->mesh_key = surface_->mesh().key();
        gpu_->content_key = 0;
        const std::size_t vertex_rows = rows_for(2 * mesh.positions.size());
        const std::size_t triangle_rows = rows_for(mesh.triangle_count());
        vertices_.assign(vertex_rows * row_length, glm::vec4(0.0F));
        gpu_->vertices =
            gl::Texture::make_2d(pass.gl(), static_cast<int>(row_length), static_cast<int>(vertex_rows),
                                 PixelFormat::rgba32f, "vertices of a bake");
        gpu_->triangles =
            gl::Texture::make_2d(pass.gl(), static_cast<int>(row_length), static_cast<int>(triangle_rows),
                                 PixelFormat::rgba32f, "triangles of a bake");
        // Numbers below 2^24 are whole in a float.
        std::vector<glm::vec4> triangles(triangle_rows * row_length, glm::vec4(0.0F));
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
            triangles[t] = {mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2], 0.0F};
        }
        gpu_->triangles->upload(std::as_bytes(std::span(triangles)));
    }
    if (gpu_->content_key != content_key_) {
        gpu_->content_key = content_key_;
        fill_vertices();
        gpu_->vertices->upload(std::as_bytes(std::span(vertices_)));
    }
    if (gpu_->map_of != map_) {
        gpu_->map_of = map_;
        gpu_->map =
            gl::Texture::make_2d(pass.gl(), map_->size, map_->size, PixelFormat::rgba32f, "texels of a bake");
        gpu_->map->upload(std::as_bytes(std::span(map_->texels)));
    }
}

void BakeEffect::draw(const Pass& pass) {
    upload(pass);
    const gl::Program& program = pass.use(wanted_);
    pass.bind(program, "u_map", *gpu_->map, gl::Filter::nearest);
    pass.bind(program, "u_vertices", *gpu_->vertices, gl::Filter::nearest);
    pass.bind(program, "u_triangles", *gpu_->triangles, gl::Filter::nearest);
    program.set("u_size", static_cast<float>(map_->size));
    pass.draw_fullscreen();
}

}  // namespace viscera::tissue
