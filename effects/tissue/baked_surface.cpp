#include "effects/tissue/baked_surface.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/assets.h"

namespace viscera::tissue {
namespace {

struct BakeTarget {
    const char* port;
    const char* target;
    const char* doc;
};
constexpr std::array<BakeTarget, 4> bake_targets{
    {{"position", "tissue.position", "Of the bake: place of each texel in the world [mm]."},
     {"normal", "tissue.normal", "Of the bake."},
     {"metric", "tissue.metric", "Of the bake."},
     {"seam", "tissue.seam", "Of the bake."}}};

}  // namespace

void visit_size(ParamVisitor& v, int& size) {
    v.field({.name = "size",
             .doc = "Texels along each side, the same for a bake and all that is painted on it.",
             .unit = "px",
             .min = 16,
             .max = 8192},
            size);
}

SizeRule square(int size) {
    return {.width = size, .height = size};
}

Port read_bake(std::string_view name) {
    const auto* const found =
        std::ranges::find_if(bake_targets, [&](const BakeTarget& target) { return target.port == name; });
    return {.name = found->port, .access = Access::read, .target = found->target, .doc = found->doc};
}

void check_size(const Prepare& prepare, std::string_view written) {
    const glm::ivec2 bake = prepare.size("position");
    const glm::ivec2 own = prepare.size(written);
    if (bake != own) {
        throw Error(ErrorCode::scene, "/size",
                    "makes '" + std::string(written) + "' " + std::to_string(own.x) +
                        " texels wide; the bake that the pass reads is " + std::to_string(bake.x) + " wide");
    }
}

BakedSurface::BakedSurface(std::shared_ptr<SurfaceMesh> mesh, const SurfaceMeshParams& params, int size)
    : mesh_(std::move(mesh)),
      name_(params.file.path.string()),
      host_positions_(params.host_positions),
      to_world_(placement_matrix(params.placement, mesh_->centre())),
      size_(size) {}

std::shared_ptr<BakedSurface> BakedSurface::load(Assets& assets, const SurfaceMeshParams& params, int size) {
    std::shared_ptr<SurfaceMesh> mesh = SurfaceMesh::load(assets, params);
    // The array's name apart from the content: two meshes of one content may be moved by two arrays.
    const std::uint64_t key = Hash()
                                  .add(mesh->key())
                                  .add(params.host_positions)
                                  .add(placement_matrix(params.placement, mesh->centre()))
                                  .add(size)
                                  .value();
    return assets.shared<BakedSurface>(
        key, [&] { return std::make_shared<BakedSurface>(std::move(mesh), params, size); });
}

void BakedSurface::move(Prepare& prepare) {
    mesh_->move(prepare.frame().values, host_positions_, prepare.log());
}

void BakedSurface::check_bake(Prepare& prepare, std::string_view pass) const {
    check_mesh(prepare, pass, mesh_->key(), name_);
    if (prepare.subject("position") == mesh_->key() && baker_.expired()) {
        prepare.log().fault("tissue.other_place",
                            std::string(pass) +
                                " has another 'mesh.placement' or 'mesh.host_positions' of '" + name_ +
                                "' than the bake that it reads: it looks for places where they are not");
    }
}

void check_mesh(Prepare& prepare, std::string_view pass, std::uint64_t mesh_key, const std::string& name) {
    const std::uint64_t subject = prepare.subject("position");
    if (subject != 0 && subject != mesh_key) {
        prepare.log().fault("tissue.other_mesh",
                            std::string(pass) + " has '" + name +
                                "' as its mesh, but the bake that it reads is of another mesh or atlas: "
                                "it will paint in the wrong places");
    }
}

const std::shared_ptr<const TexelMap>& BakedSurface::map(Assets& assets) {
    if (!map_) {
        map_ = shared_texel_map(assets, *mesh_, size_, name_);
    }
    return map_;
}

TileTree& BakedSurface::tiles(Assets& assets) {
    if (!tiles_) {
        tiles_.emplace(map(assets));
    }
    if (tiles_shape_ != mesh_->shape_key()) {
        tiles_shape_ = mesh_->shape_key();
        world_.resize(mesh_->data().positions.size());
        std::ranges::transform(mesh_->data().positions, world_.begin(), [this](const glm::vec3& p) {
            return glm::vec3(to_world_ * glm::dvec4(p, 1.0));
        });
        tiles_->place(world_, mesh_->data().indices);
    }
    return *tiles_;
}

}  // namespace viscera::tissue
