#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/mesh_data.h"
#include "engine/core/params.h"
#include "engine/core/placement.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/frame.h"
#include "engine/runtime/mesh_file.h"
#include "engine/runtime/texture_space.h"

namespace viscera {

class Assets;
class Log;

/// A mesh that passes paint on: which one, where it is put, and who moves it.
struct SurfaceMeshParams : MeshFile {
    PlacementParams placement;
    std::string host_positions;
    AtlasSource atlas = AtlasSource::automatic;

    void visit(ParamVisitor& v);
};

/// A mesh with one place in texture space for each of its points, shared by all passes that name the same
/// file. Texture space has its origin at the bottom left; the texel (x, y) of w x h has its centre at
/// ((x + 0.5) / w, (y + 0.5) / h).
///
/// Vertices are those of the merged file first, in its order (merged_vertex_count() of them); where an atlas
/// had to be made, further ones follow, which repeat one of these at the border of a chart.
class SurfaceMesh {
  public:
    explicit SurfaceMesh(TextureSpace space);

    /// From the file, made on first use; every pass with the same file, filter, unit, atlas and
    /// host_positions gets the same object. Throws as io::load_meshes().
    [[nodiscard]] static std::shared_ptr<SurfaceMesh> load(Assets& assets, const SurfaceMeshParams& params);

    /// For prepare(): takes the host's positions of this frame, 3 floats [mm] per merged vertex in the file's
    /// frame, in place of the file's; none given: the file's. Of another count or not finite: a fault, and
    /// the file's positions. Normals turn as the surface turns. Cheap when nothing has changed; allocates
    /// nothing.
    void move(const HostValues* values, std::string_view name, Log& log);

    /// Content of the mesh as it was loaded, atlas included; the subject (Work::subject) of what is painted
    /// on it.
    [[nodiscard]] std::uint64_t key() const { return key_; }
    /// Content of the present positions; changes whenever they do.
    [[nodiscard]] std::uint64_t shape_key() const { return shape_key_; }
    /// With the present positions and normals; uvs always there.
    [[nodiscard]] const MeshData& data() const { return data_; }
    /// As the file has them, wherever a host has moved them.
    [[nodiscard]] std::span<const glm::vec3> file_positions() const {
        return file_positions_.empty() ? data_.positions : file_positions_;
    }
    /// The file's own texture coordinates, which its pictures are made for; data().uvs where it has none.
    [[nodiscard]] std::span<const glm::vec2> picture_uvs() const { return picture_uvs_; }
    /// Per vertex the first one at the same place in the file: seams closed.
    [[nodiscard]] std::span<const std::uint32_t> places() const { return place_; }
    [[nodiscard]] const Bounds& bounds() const { return bounds_; }
    /// Where a placement turns about: the centre of the file's box.
    [[nodiscard]] const glm::dvec3& centre() const { return centre_; }
    [[nodiscard]] std::size_t merged_vertex_count() const { return merged_count_; }
    /// The vertex that stands for a merged vertex wherever it is repeated; any other is its own.
    [[nodiscard]] std::uint32_t merged_vertex(std::uint32_t vertex) const {
        return vertex < merged_count_ ? vertex : origin_[vertex - merged_count_];
    }

    /// For draw(): the triangles on the GPU, brought up to date. a_uv is texture space, a_picture_uv the
    /// file's own coordinates, which its pictures are made for.
    [[nodiscard]] const gl::Mesh& gpu(const gl::Functions& gl);

  private:
    void set_positions(std::span<const float> xyz);
    void turn_normals();

    MeshData data_;
    std::vector<glm::vec2> picture_uvs_;
    std::vector<std::uint32_t> origin_;  ///< per vertex after the merged ones: which of these it repeats
    std::vector<std::uint32_t> place_;
    std::vector<glm::vec3> file_positions_;
    std::vector<glm::vec3> file_normals_;
    std::vector<glm::vec3> file_smooth_normals_;  ///< of the file's positions, joined across seams
    std::vector<glm::vec3> smooth_normals_;       ///< of the present ones
    Bounds bounds_;
    glm::dvec3 centre_{0.0};
    std::size_t merged_count_ = 0;
    std::uint64_t key_ = 0;
    std::uint64_t shape_key_ = 0;
    std::uint64_t host_version_ = 0;
    std::unique_ptr<gl::Mesh> gpu_;
    std::uint64_t gpu_shape_ = 0;
};

}  // namespace viscera
