#include "engine/runtime/texture_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/core/mesh_atlas.h"
#include "engine/core/mesh_normals.h"
#include "engine/io/mesh.h"
#include "engine/io/packed.h"
#include "engine/runtime/assets.h"

namespace viscera {
namespace {

constexpr std::array<std::string_view, 3> source_names{"automatic", "file", "generated"};

// Less than this is a stray texel between charts that touch.
constexpr double least_overlap = 0.01;

// A few triangles without area happen; a part of the mesh must not.
constexpr double most_flat = 0.01;

std::string percent(double share) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.0f %%", 100.0 * share);
    return text.data();
}

/// Why coordinates cannot be painted by; empty when they can.
std::string fault_of(const MeshData& mesh) {
    if (mesh.uvs.empty()) {
        return "has no texture coordinates";
    }
    const UvUse use = measure_uvs(mesh.uvs, mesh.indices);
    if (use.covered == 0.0) {
        return "has texture coordinates that span no area";
    }
    if (use.overlap > least_overlap) {
        return "puts several triangles on one place of the texture (" + percent(use.overlap) + " of it)";
    }
    if (use.flat > most_flat) {
        return "has no texture coordinates for " + percent(use.flat) + " of its triangles";
    }
    if (use.beyond) {
        return "has texture coordinates outside [0, 1]";
    }
    return {};
}

/// Each mesh's own atlas becomes a tile of a square grid. False where some mesh has no usable one.
bool tile(std::span<const MeshData> parts, MeshData& merged) {
    std::size_t used = 0;
    for (const MeshData& part : parts) {
        if (!part.indices.empty()) {
            ++used;
            if (!fault_of(part).empty()) {
                return false;
            }
        }
    }
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(used))));
    const double size = 1.0 / static_cast<double>(side);
    std::size_t cell = 0;
    std::size_t vertex = 0;
    for (const MeshData& part : parts) {
        const std::size_t row = cell / side;
        const glm::dvec2 corner(size * static_cast<double>(cell % side), size * static_cast<double>(row));
        for (const glm::vec2& uv : part.uvs) {
            merged.uvs[vertex++] = corner + 0.5 * atlas_gap + (size - atlas_gap) * glm::dvec2(uv);
        }
        cell += part.indices.empty() ? 0 : 1;
    }
    return true;
}

void use_atlas(TextureSpace& space, const MeshAtlas& atlas) {
    MeshData& mesh = space.mesh;
    const bool had_uvs = !mesh.uvs.empty();
    space.picture_uvs = had_uvs ? mesh.uvs : atlas.uvs;
    for (const std::uint32_t vertex : atlas.origin) {
        mesh.positions.push_back(mesh.positions[vertex]);
        mesh.normals.push_back(mesh.normals[vertex]);
        for (VertexScalars& scalars : mesh.scalars) {
            scalars.values.push_back(scalars.values[vertex]);
        }
        if (had_uvs) {
            space.picture_uvs.push_back(space.picture_uvs[vertex]);
        }
    }
    mesh.uvs = atlas.uvs;
    mesh.indices = atlas.indices;
    space.origin = atlas.origin;
}

/// Named in the disk cache; another number when atlases are made in another way.
constexpr std::string_view cached_kind = "mesh-atlas-2";

std::optional<MeshAtlas> kept_atlas(const io::DiskCache& cache, std::uint64_t key, const MeshData& mesh) {
    const auto bytes = cache.load(cached_kind, key);
    if (!bytes) {
        return std::nullopt;
    }
    MeshAtlas atlas;
    io::Unpacker unpacker(*bytes);
    unpacker.read(atlas.indices).read(atlas.origin).read(atlas.uvs).read(atlas.charts).read(atlas.scale);
    unpacker.read(atlas.coverage).read(atlas.mean_stretch).read(atlas.most_stretch);
    const std::size_t vertices = mesh.positions.size() + atlas.origin.size();
    const auto below = [](const std::vector<std::uint32_t>& values, std::size_t limit) {
        return std::ranges::all_of(values, [limit](std::uint32_t value) { return value < limit; });
    };
    const bool fits = unpacker.complete() && atlas.indices.size() == mesh.indices.size() &&
                      atlas.uvs.size() == vertices && below(atlas.indices, vertices) &&
                      below(atlas.origin, mesh.positions.size());
    return fits ? std::optional(std::move(atlas)) : std::nullopt;
}

MeshAtlas atlas_of(const MeshData& mesh, const std::string& where, Assets& assets) {
    const std::uint64_t key = Hash()
                                  .bytes(std::as_bytes(std::span(mesh.positions)))
                                  .bytes(std::as_bytes(std::span(mesh.indices)))
                                  .value();
    if (auto kept = kept_atlas(assets.disk_cache(), key, mesh)) {
        return std::move(*kept);
    }
    const std::vector<std::uint32_t> place = io::first_at_same_place(mesh.positions);
    MeshAtlas atlas = make_atlas(mesh.positions, mesh.indices, place,
                                 assets.progress("making a texture atlas for " + where));
    io::Packer packer;
    packer.add(atlas.indices).add(atlas.origin).add(atlas.uvs).add(atlas.charts).add(atlas.scale);
    packer.add(atlas.coverage).add(atlas.mean_stretch).add(atlas.most_stretch);
    assets.disk_cache().store(cached_kind, key, packer.bytes());
    return atlas;
}

std::string describe(const MeshAtlas& atlas) {
    std::array<char, 160> text{};
    std::snprintf(
        text.data(), text.size(),
        "an atlas of %zu charts was made: it covers %.0f %% of the texture, texels are stretched by "
        "%.2f on average and %.2f at most",
        atlas.charts, 100.0 * atlas.coverage, atlas.mean_stretch, atlas.most_stretch);
    return text.data();
}

/// Closes the shading where parts meet.
void join_parts(std::span<const MeshData> parts, MeshData& mesh, const std::string& where, Log& log) {
    std::vector<std::size_t> counts;
    for (const MeshData& part : parts) {
        counts.push_back(part.positions.size());
    }
    const std::size_t joined = join_normals(mesh, counts, io::first_at_same_place(mesh.positions));
    if (joined > 0) {
        log.info(where + ": its " + std::to_string(parts.size()) + " meshes meet at " +
                 std::to_string(joined) + " places, where they get one normal");
    }
}

}  // namespace

std::span<const std::string_view> choice_names(AtlasSource) {
    return source_names;
}

TextureSpace make_texture_space(std::span<const MeshData> parts, AtlasSource source, const std::string& where,
                                Assets& assets) {
    TextureSpace space{.mesh = io::merge(parts), .picture_uvs = {}, .origin = {}};
    MeshData& mesh = space.mesh;
    if (mesh.indices.empty()) {
        mesh.uvs.resize(mesh.positions.size());
        space.picture_uvs = mesh.uvs;
        return space;
    }
    join_parts(parts, mesh, where, assets.log());
    const std::string fault =
        source == AtlasSource::generated ? "is to be painted by an atlas of its own" : fault_of(mesh);
    const bool keep = fault.empty() || (source == AtlasSource::file && !mesh.uvs.empty());
    if (keep) {
        if (!fault.empty()) {
            assets.log().fault("surface.uv", where + ": " + fault + "; it is painted by them as they are");
        }
        space.picture_uvs = mesh.uvs;
        return space;
    }
    if (source == AtlasSource::automatic && !mesh.uvs.empty()) {
        space.picture_uvs = mesh.uvs;
        if (tile(parts, mesh)) {
            assets.log().info(where +
                              ": its meshes share places of the texture; each gets a tile of its own");
            return space;
        }
    }
    const MeshAtlas atlas = atlas_of(mesh, where, assets);
    use_atlas(space, atlas);
    assets.log().info(where + ": " + fault + "; " + describe(atlas));
    return space;
}

}  // namespace viscera
