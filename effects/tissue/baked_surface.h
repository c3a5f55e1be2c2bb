#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/texel_map.h"
#include "effects/tissue/tile_tree.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/surface_mesh.h"

// What passes that paint on a baked surface have in common.
namespace viscera::tissue {

/// The parameter `size` of a bake and of every pass that paints on one.
void visit_size(ParamVisitor& v, int& size);
[[nodiscard]] SizeRule square(int size);

/// A port that reads what a bake wrote: position, normal, metric or seam.
[[nodiscard]] Port read_bake(std::string_view name);

/// Throws Error(scene) when the bake that a pass reads has another size than the target that it writes.
void check_size(const Prepare& prepare, std::string_view written);

/// Says so when the bake that a pass reads is of another mesh. `pass`: its effect's name; `name`: its mesh's
/// file.
void check_mesh(Prepare& prepare, std::string_view pass, std::uint64_t mesh_key, const std::string& name);

/// A mesh where it lies in the world, with the texels that stand for its points: one object for all passes
/// that paint on it at one size.
class BakedSurface {
  public:
    BakedSurface(std::shared_ptr<SurfaceMesh> mesh, const SurfaceMeshParams& params, int size);

    /// `size`: texels along each side. Throws as SurfaceMesh::load().
    [[nodiscard]] static std::shared_ptr<BakedSurface> load(Assets& assets, const SurfaceMeshParams& params,
                                                            int size);

    /// Takes the host's vertices of this frame, see SurfaceMesh::move().
    void move(Prepare& prepare);

    /// A bake draws this surface, at this place, for as long as it holds `baker`.
    void set_baker(const std::shared_ptr<const void>& baker) { baker_ = baker; }
    /// Says so when the bake that a pass reads is of another mesh, or of this one where another placement or
    /// host puts it. `pass`: its effect's name.
    void check_bake(Prepare& prepare, std::string_view pass) const;
    [[nodiscard]] const SurfaceMesh& mesh() const { return *mesh_; }
    [[nodiscard]] const glm::dmat4& to_world() const { return to_world_; }
    [[nodiscard]] int size() const { return size_; }
    /// Which point each texel stands for; found on first use.
    [[nodiscard]] const std::shared_ptr<const TexelMap>& map(Assets& assets);
    /// Which texels lie near a place, as the surface lies now.
    [[nodiscard]] TileTree& tiles(Assets& assets);

  private:
    std::shared_ptr<SurfaceMesh> mesh_;
    std::string name_;            ///< of the file, for whoever waits
    std::string host_positions_;  ///< name of the host's array
    glm::dmat4 to_world_{1.0};
    int size_ = 0;
    std::weak_ptr<const void> baker_;
    std::shared_ptr<const TexelMap> map_;
    std::optional<TileTree> tiles_;
    std::uint64_t tiles_shape_ = 0;  ///< of the positions that the tiles were placed by
    std::vector<glm::vec3> world_;   ///< the mesh's vertices [mm]
};

}  // namespace viscera::tissue
