#include "tests/tissue/bake_stage.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "effects/register_all.h"
#include "engine/core/scene.h"
#include "engine/io/mesh.h"

namespace viscera::test {

using nlohmann::json;

BakeStage::BakeStage(std::filesystem::path cache_folder)
    : context_(create_context(Backend::osmesa, {.debug = true})) {
    register_all(registry_);
    RendererOptions options;
    options.log = [this](LogLevel level, std::string_view message) {
        if (level != LogLevel::debug) {
            said_.emplace_back(message);
        }
    };
    options.progress = [this](std::string_view what, double) {
        if (long_work_.empty() || long_work_.back() != what) {
            long_work_.emplace_back(what);
        }
        return true;
    };
    options.cache_folder = std::move(cache_folder);
    renderer_ = std::make_unique<Renderer>(context_->proc_address(), registry_, std::move(options));
    parameters = {{"mesh", json::object()}, {"size", 64}};
}

void BakeStage::use(const MeshData& mesh) {
    std::string obj;
    const auto line = [&](const char* format, auto... numbers) {
        std::array<char, 160> text{};
        std::snprintf(text.data(), text.size(), format, numbers...);
        obj += text.data();
    };
    for (const glm::vec3& p : mesh.positions) {
        line("v %.9g %.9g %.9g\n", double{p.x}, double{p.y}, double{p.z});
    }
    for (const glm::vec2& uv : mesh.uvs) {
        line("vt %.9g %.9g\n", double{uv.x}, double{uv.y});
    }
    for (const glm::vec3& n : mesh.normals) {
        line("vn %.9g %.9g %.9g\n", double{n.x}, double{n.y}, double{n.z});
    }
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        obj += "f";
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string i = std::to_string(mesh.indices[t + k] + 1);
            obj += " " + i + "/" + (mesh.uvs.empty() ? "" : i) + (mesh.normals.empty() ? "" : "/" + i);
        }
        obj += "\n";
    }
    static int number = 0;
    parameters["mesh"]["file"] = folder_.write("mesh" + std::to_string(++number) + ".obj", obj).string();
}

void BakeStage::load() {
    json outputs = {"tissue.position"};
    if (all_outputs) {
        outputs = {"tissue.position", "tissue.normal", "tissue.metric", "tissue.seam"};
    }
    const json scene = {
        {"version", 1},
        {"resolution", {16, 16}},
        {"passes", {{{"name", "bake"}, {"effect", "tissue.bake"}, {"parameters", parameters}}}},
        {"targets", {{"tissue.normal", {{"format", "rgba32f"}}}}},
        {"outputs", outputs}};
    json described = scene;
    if (!all_outputs) {
        described.erase("targets");
    }
    if (described != loaded_) {
        loaded_ = described;
        renderer_->set_scene(parse_scene(described.dump(), "test.json"));
    }
}

const FrameReport& BakeStage::render(const HostValues* values) {
    load();
    Frame frame = renderer_->still(0.0);
    frame.values = values;
    return renderer_->render(frame);
}

Baked BakeStage::bake(const HostValues* values) {
    render(values);
    Baked baked;
    baked.position = renderer_->read("tissue.position");
    if (all_outputs) {
        baked.normal = renderer_->read("tissue.normal");
        baked.metric = renderer_->read("tissue.metric");
        baked.seam = renderer_->read("tissue.seam");
    }
    baked.width = baked.position.width;
    baked.height = baked.position.height;
    return baked;
}

bool BakeStage::has_said(const std::string& words) const {
    return std::ranges::any_of(
        said_, [&](const std::string& message) { return message.find(words) != std::string::npos; });
}

MeshData sheet(int n, int m, const std::function<glm::dvec3(double, double)>& place,
               const std::function<glm::dvec2(double, double)>& uv) {
    MeshData mesh;
    for (int j = 0; j <= m; ++j) {
        for (int i = 0; i <= n; ++i) {
            const double s = static_cast<double>(i) / n;
            const double t = static_cast<double>(j) / m;
            mesh.positions.emplace_back(place(s, t));
            mesh.uvs.emplace_back(uv(s, t));
        }
    }
    const auto row = static_cast<std::uint32_t>(n + 1);
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(m); ++j) {
        for (std::uint32_t i = 0; i + 1 < row; ++i) {
            const std::uint32_t a = j * row + i;
            for (const std::uint32_t corner : {a, a + 1, a + row + 1, a, a + row + 1, a + row}) {
                mesh.indices.push_back(corner);
            }
        }
    }
    mesh.normals = io::vertex_normals(mesh);
    return mesh;
}

MeshData together(const MeshData& a, const MeshData& b) {
    return io::merge(std::array{a, b});
}

reference::BakedSurface surface_of(const MeshData& mesh) {
    return {{mesh.positions.begin(), mesh.positions.end()},
            {mesh.normals.begin(), mesh.normals.end()},
            {mesh.uvs.begin(), mesh.uvs.end()},
            mesh.indices};
}

double ulps(double difference, double size) {
    return std::abs(difference) / (std::exp2(std::floor(std::log2(std::max(size, 1e-30)))) * 0x1.0p-23);
}

}  // namespace viscera::test
