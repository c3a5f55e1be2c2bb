#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"

namespace viscera::io {

namespace {

glm::vec3 to_glm(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

/// Faces of one or two corners are points and lines, of which a surface has no use.
RawMesh convert(const aiMesh& source, std::size_t& not_triangles) {
    RawMesh raw;
    raw.weld = true;
    MeshData& mesh = raw.mesh;
    mesh.name = source.mName.C_Str();
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
        mesh.positions.push_back(to_glm(source.mVertices[v]));
        if (source.HasNormals()) {
            mesh.normals.push_back(to_glm(source.mNormals[v]));
        }
        if (source.HasTextureCoords(0)) {
            mesh.uvs.emplace_back(source.mTextureCoords[0][v].x, source.mTextureCoords[0][v].y);
        }
    }
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
        const aiFace& face = source.mFaces[f];
        if (face.mNumIndices < 3) {
            ++not_triangles;
        }
        append_fan(
            face.mNumIndices, [&](std::size_t i) { return face.mIndices[i]; }, mesh.indices);
    }
    return raw;
}

}  // namespace

std::vector<RawMesh> read_with_assimp(const std::filesystem::path& file, Log& log) {
    constexpr std::size_t most_bytes = std::size_t{1} << 31U;
    const std::string bytes = read_file(file, most_bytes);
    const std::string extension = lower_extension(file);
    try {
        // From memory, so that a material library or anything else that the file names is never opened.
        Assimp::Importer importer;
        int unused = aiComponent_COLORS | aiComponent_MATERIALS | aiComponent_TEXTURES;
        if (extension == ".stl") {
            unused |= aiComponent_NORMALS;  // one per triangle, they would keep vertices apart
        }
        importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, unused);
        const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(),
                                                           aiProcess_Triangulate | aiProcess_RemoveComponent,
                                                           extension.c_str() + 1);
        if (scene == nullptr) {
            throw Error(ErrorCode::file, file.string(),
                        std::string("is no readable mesh: ") + importer.GetErrorString());
        }
        std::vector<RawMesh> meshes;
        std::size_t not_triangles = 0;
        for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
            meshes.push_back(convert(*scene->mMeshes[m], not_triangles));
            if (meshes.back().mesh.name.empty()) {
                meshes.back().mesh.name = file.stem().string();
            }
        }
        if (not_triangles > 0) {
            log.fault("mesh: points and lines left out",
                      file.string() + ": " + std::to_string(not_triangles) + " points and lines left out",
                      not_triangles);
        }
        return meshes;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable mesh: ") + error.what());
    }
}

}  // namespace viscera::io
