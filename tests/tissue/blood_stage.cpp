#include "tests/tissue/blood_stage.h"

#include <array>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "engine/io/exr.h"

namespace viscera::test {

using nlohmann::json;

std::string surface_obj(std::span<const SurfaceChart> charts, int size,
                        const std::function<glm::dvec3(glm::dvec2)>& place) {
    std::ostringstream text;
    text.precision(12);
    int count = 0;
    for (const SurfaceChart& chart : charts) {
        const glm::ivec2 n = chart.cells;
        for (int j = 0; j <= n.y; ++j) {
            for (int i = 0; i <= n.x; ++i) {
                const glm::dvec2 at = chart.low + (chart.high - chart.low) * glm::dvec2(i, j) / glm::dvec2(n);
                const glm::dvec3 p = place(at);
                const glm::dvec2 uv =
                    (chart.origin_px + at.x * chart.a_px + at.y * chart.b_px) / static_cast<double>(size);
                text << "v " << p.x << ' ' << p.y << ' ' << p.z << "\nvt " << uv.x << ' ' << uv.y << '\n';
            }
        }
        for (int j = 0; j < n.y; ++j) {
            for (int i = 0; i < n.x; ++i) {
                const int a = count + j * (n.x + 1) + i + 1;
                const int c = a + n.x + 1;
                const auto corner = [](int k) { return std::to_string(k) + '/' + std::to_string(k); };
                text << "f " << corner(a) << ' ' << corner(a + 1) << ' ' << corner(c + 1) << "\nf "
                     << corner(a) << ' ' << corner(c + 1) << ' ' << corner(c) << '\n';
            }
        }
        count += (n.x + 1) * (n.y + 1);
    }
    return text.str();
}

BloodStage::BloodStage(int texels, Backend backend) : size(texels), stage_(backend) {}

void BloodStage::surface(std::span<const SurfaceChart> charts,
                         const std::function<glm::dvec3(glm::dvec2)>& place) {
    mesh["file"] = folder.write("surface.obj", surface_obj(charts, size, place)).string();
}

json BloodStage::scene() const {
    json gravity_parameters = gravity;
    gravity_parameters["size"] = size;
    json blood_parameters = blood;
    blood_parameters["size"] = size;
    blood_parameters["mesh"] = mesh;
    json passes = json::array({pass("bake", "tissue.bake", {{"mesh", mesh}, {"size", size}})});
    const auto add_picture = [&](const char* name, const std::string& file, const std::string& target) {
        if (!file.empty()) {
            passes.push_back(pass(name, "picture.image",
                                  {{"file", file}, {"fit", "stretch"}, {"monochrome", true}},
                                  {{"image", target}}));
        }
    };
    add_picture("relief", relief_file_, "tissue.relief");
    passes.push_back(pass("gravity", "tissue.gravity", gravity_parameters));
    add_picture("spill", spill_file_, "tissue.blood_spill");
    passes.insert(passes.end(), more.begin(), more.end());
    passes.push_back(pass("blood", "tissue.blood", blood_parameters));
    passes.push_back(pass("account", "tissue.blood_account", {{"state", blood.value("state", "blood")}}));
    json scene =
        scene_of({{"kind", "perspective"}}, passes,
                 {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal", "tissue.blood_account",
                  "tissue.position", "tissue.normal", "tissue.metric", "tissue.seam", "tissue.gravity"},
                 64, 64);
    scene["targets"]["tissue.blood_height"]["format"] = "r32f";
    scene["targets"]["tissue.normal"]["format"] = "rgba32f";
    if (!spill_file_.empty()) {
        scene["targets"]["tissue.blood_spill"] = {{"format", "r32f"}, {"size", {size, size}}};
    }
    if (!relief_file_.empty()) {
        scene["targets"]["tissue.relief"] = {{"format", "r32f"}, {"size", {size, size}}};
        scene["outputs"].push_back("tissue.relief");
    }
    return scene;
}

void BloodStage::load() {
    stage_.load(scene());
}

std::string BloodStage::picture(const char* name, bool gutters,
                                const std::function<double(const glm::dvec3&)>& value) {
    load();
    frame(0.0);
    const Image position = read("tissue.position");
    Image image = make_image(size, size, PixelFormat::r32f);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            if (position.at(x, y, 3) == 1.0F || (gutters && position.at(x, y, 3) > 0.0F)) {
                const glm::dvec3 p(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
                image.set(x, y, 0, static_cast<float>(value(p)));
            }
        }
    }
    const std::array<io::ExrPart, 1> parts{io::ExrPart{.name = "picture", .image = image}};
    std::string file = (folder / (std::string(name) + ".exr")).string();
    io::write_exr(file, parts, io::ExrCompression::none);
    // Another name, so that nothing of the frame above goes on.
    blood["state"] = name;
    return file;
}

void BloodStage::relief(const std::function<double(const glm::dvec3&)>& height_mm) {
    relief_file_ = picture("relief", true, height_mm);
    load();
}

void BloodStage::spill(const std::function<double(const glm::dvec3&)>& height_mm) {
    spill_file_ = picture("spilt", false, height_mm);
    load();
}

const FrameReport& BloodStage::frame(double time_s, const HostValues* values) {
    time_s_ = time_s;
    return stage_.render(time_s, values);
}

const FrameReport& BloodStage::run(double from_s, double to_s, double step_s, const HostValues* values) {
    const auto frames = std::lround((to_s - from_s) / step_s);
    for (long i = 0; i < frames; ++i) {
        frame(from_s + static_cast<double>(i) * step_s, values);
    }
    return frame(to_s, values);
}

BloodAccount account_of(const Image& picture) {
    const std::vector<float> values = to_floats(picture);
    BloodAccount sum;
    for (std::size_t i = 0; i + 3 < values.size(); i += 4) {
        sum.given += static_cast<double>(values[i]);
        sum.film += static_cast<double>(values[i + 1]);
        sum.drops += static_cast<double>(values[i + 2]);
        sum.gone += static_cast<double>(values[i + 3]);
    }
    return sum;
}

reference::TissueSurface BloodStage::baked() {
    using Texel = reference::TissueSurface::Texel;
    const Image position = read("tissue.position");
    const Image normal = read("tissue.normal");
    const Image metric = read("tissue.metric");
    const Image seam = read("tissue.seam");
    reference::TissueSurface surface{.width = size, .height = size};
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const float coverage = position.at(x, y, 3);
            const glm::dvec2 jump(seam.at(x, y, 0), seam.at(x, y, 1));
            surface.kind.push_back(coverage == 1.0F   ? Texel::cell
                                   : coverage == 0.0F ? Texel::nothing
                                   : jump.x >= 0.0    ? Texel::gutter
                                                      : Texel::open_gutter);
            surface.position.emplace_back(position.at(x, y, 0), position.at(x, y, 1), position.at(x, y, 2));
            surface.normal.emplace_back(normal.at(x, y, 0), normal.at(x, y, 1), normal.at(x, y, 2));
            surface.metric.emplace_back(metric.at(x, y, 0), metric.at(x, y, 1), metric.at(x, y, 2),
                                        metric.at(x, y, 3));
            surface.seam.push_back(jump);
        }
    }
    return surface;
}

void expect_finite(const Image& image) {
    for (const float value : to_floats(image)) {
        ASSERT_TRUE(std::isfinite(value));
    }
}

void expect_finite(BloodStage& stage) {
    for (const char* target : {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"}) {
        SCOPED_TRACE(target);
        expect_finite(stage.read(target));
    }
}

}  // namespace viscera::test
