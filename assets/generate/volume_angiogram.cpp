#include "assets/generate/volume_angiogram.h"

#include <array>
#include <string>

#include "assets/generate/noise.h"
#include "assets/generate/random.h"
#include "assets/generate/vessel_field.h"
#include "assets/generate/volume_canvas.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

constexpr double box_mm = 153.6;
constexpr double node_step_mm = 1.5;
constexpr double aorta_radius_mm = 8.0;

/// Courses that branch off each other.
class Arteries {
  public:
    explicit Arteries(std::uint64_t seed) : random_(seed) {}

    /// A large artery through given points; `at` is the fraction of the parent's length it leaves from.
    int artery(const std::string& name, int parent, double at, std::vector<glm::dvec3> way,
               double tip_weight) {
        std::size_t point = 0;
        if (parent >= 0) {
            const auto& from = courses_[static_cast<std::size_t>(parent)].points;
            point = static_cast<std::size_t>(at * static_cast<double>(from.size() - 1));
            way.insert(way.begin(), from[point]);
        }
        courses_.push_back({.name = name,
                            .parent = parent,
                            .parent_point = point,
                            .points = resample(spline(way, 16), node_step_mm),
                            .tip_weight = tip_weight});
        return static_cast<int>(courses_.size()) - 1;
    }

    /// Branches along the outer part of an artery, to alternating sides, and branches of those.
    void branch_out(int parent, int count, double length_mm, int generations) {
        for (int i = 0; i < count; ++i) {
            const auto& from = courses_[static_cast<std::size_t>(parent)].points;
            const double at = 0.35 + 0.6 * (i + random_.uniform(0.2, 0.8)) / count;
            const auto point = static_cast<std::size_t>(at * static_cast<double>(from.size() - 1));
            const glm::dvec3 ahead =
                glm::normalize(from[std::min(point + 2, from.size() - 1)] - from[point > 0 ? point - 1 : 0]);
            const glm::dvec3 side = glm::normalize(
                glm::cross(ahead, glm::dvec3(random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0), 0.3)));
            const double length = length_mm * random_.uniform(0.75, 1.25);
            const glm::dvec3 out = (i % 2 == 0 ? 1.0 : -1.0) * side;
            const glm::dvec3 bend = 0.25 * glm::cross(out, ahead) * random_.uniform(-1.0, 1.0);
            const glm::dvec3 start = from[point];
            const std::vector<glm::dvec3> way{start + length * (0.35 * out + 0.25 * ahead),
                                              start + length * (0.6 * out + 0.55 * ahead + bend),
                                              start + length * (0.75 * out + 0.95 * ahead + 0.5 * bend)};
            const int child = artery("branch", parent, at, way, 1.0);
            if (generations > 1) {
                branch_out(child, count, 0.62 * length_mm, generations - 1);
            }
        }
    }

    [[nodiscard]] VesselTree tree() const {
        return join_courses(courses_, {.root_radius_mm = aorta_radius_mm, .taper_per_mm = 0.0});
    }
    Random& random() { return random_; }

  private:
    Random random_;
    std::vector<Course> courses_;
};

glm::vec3 kidney_centre(float side) {
    return {side * 58.0F, 26.0F, side > 0.0F ? 8.0F : 0.0F};
}

/// What is not vessel, darkest first.
void paint_tissue(Canvas& canvas, std::uint32_t seed) {
    const auto texture = [seed](const glm::vec3& p, double feature_mm) {
        return static_cast<float>(gradient_noise(glm::dvec3(p) / feature_mm, seed));
    };
    canvas.paint(
        {}, 1,
        [](const glm::vec3& p) {
            return ellipse({p.x, p.y - 4.0F}, {104.0F, 70.0F});
        },
        [&](const glm::vec3& p, float d) { return (d > -9.0F ? 230.0F : 95.0F) + 22.0F * texture(p, 16.0); });
    canvas.paint(
        {}, 1,
        [](const glm::vec3& p) {
            return ellipsoid(p, {-62.0F, -14.0F, 52.0F}, {52.0F, 46.0F, 42.0F});
        },
        [&](const glm::vec3& p, float) { return 150.0F + 12.0F * texture(p, 7.0); });
    for (const float side : {-1.0F, 1.0F}) {
        canvas.paint(
            {}, 1,
            [side](const glm::vec3& p) {
                const glm::vec3 c = kidney_centre(side);
                const float whole = ellipsoid(p, c, {19.0F, 16.0F, 33.0F});
                return carve(whole, sphere(p, c - glm::vec3(side * 17.0F, 0.0F, 0.0F), 9.0F), 6.0F);
            },
            [&](const glm::vec3& p, float d) {
                return (d > -6.0F ? 330.0F : 230.0F) + 20.0F * texture(p, 6.0);
            });
        canvas.paint(
            {}, 1,
            [side](const glm::vec3& p) {
                return ellipse({p.x - side * 33.0F, p.y - 44.0F}, {14.0F, 13.0F});
            },
            70.0F);
    }
    canvas.paint(
        {}, 1,
        [](const glm::vec3& p) {
            const float level = (p.z + 200.0F) / 34.0F;
            const float disc = std::abs(level - std::floor(level) - 0.5F) * 34.0F;
            return std::max(ellipse({p.x, p.y - 42.0F}, {22.0F, 17.0F}), disc - 14.0F);
        },
        55.0F);
}

}  // namespace

VesselTree grow_abdominal_arteries(std::uint64_t seed) {
    Arteries a(seed);
    using Way = std::vector<glm::dvec3>;
    const int aorta = a.artery("aorta", -1, 0.0,
                               Way{{0, 14, 86}, {1, 13, 50}, {3, 11, 10}, {4, 13, -22}, {3, 16, -38}}, 1.0);
    const int left_iliac =
        a.artery("left common iliac", aorta, 1.0, Way{{14, 18, -54}, {32, 16, -72}, {46, 6, -92}}, 9.5);
    const int right_iliac =
        a.artery("right common iliac", aorta, 1.0, Way{{-9, 18, -54}, {-27, 17, -72}, {-42, 7, -92}}, 9.5);
    a.artery("left internal iliac", left_iliac, 0.42, Way{{34, 28, -78}, {36, 36, -92}}, 5.5);
    a.artery("right internal iliac", right_iliac, 0.42, Way{{-29, 28, -78}, {-32, 36, -92}}, 5.5);
    const int coeliac = a.artery("coeliac trunk", aorta, 0.24, Way{{1, -4, 55}, {0, -14, 54}}, 1.0);
    const int splenic =
        a.artery("splenic", coeliac, 1.0,
                 Way{{12, -12, 60}, {22, -4, 52}, {32, 0, 61}, {43, 7, 54}, {56, 14, 60}}, 3.6);
    const int hepatic =
        a.artery("common hepatic", coeliac, 1.0, Way{{-12, -18, 52}, {-26, -17, 49}, {-38, -15, 58}}, 3.4);
    const int gastric =
        a.artery("left gastric", coeliac, 0.8, Way{{7, -24, 64}, {15, -32, 70}, {24, -36, 62}}, 1.8);
    const int mesenteric = a.artery("superior mesenteric", aorta, 0.36,
                                    Way{{2, -8, 32}, {0, -20, 8}, {-6, -25, -22}, {-16, -24, -52}}, 3.2);
    const int inferior =
        a.artery("inferior mesenteric", aorta, 0.8, Way{{9, 2, -24}, {17, -2, -46}, {22, 4, -72}}, 2.0);
    const int left_renal =
        a.artery("left renal", aorta, 0.44, Way{{16, 16, 26}, {32, 23, 18}, {44, 26, 10}}, 3.8);
    const int right_renal =
        a.artery("right renal", aorta, 0.46, Way{{-12, 17, 24}, {-30, 24, 12}, {-44, 26, 2}}, 3.8);
    for (const int renal : {left_renal, right_renal}) {
        a.branch_out(renal, 4, 15.0, 3);
    }
    a.branch_out(hepatic, 4, 34.0, 3);
    a.branch_out(splenic, 3, 16.0, 3);
    a.branch_out(gastric, 4, 12.0, 2);
    a.branch_out(mesenteric, 6, 32.0, 3);
    a.branch_out(inferior, 4, 20.0, 2);
    for (const double at : {0.16, 0.31, 0.53, 0.66, 0.79, 0.92}) {  // lumbar arteries, in pairs
        const double z = 86.0 - 125.0 * at;
        for (const double side : {-1.0, 1.0}) {
            a.artery("lumbar", aorta, at,
                     Way{{side * 13.0, 24, z - 2.0}, {side * 25.0, 38, z - 3.0}, {side * 42.0, 56, z - 8.0}},
                     1.1);
        }
    }
    return a.tree();
}

Volume make_angiogram(std::uint64_t seed, int coarser) {
    VolumeGrid grid;
    grid.dims = glm::ivec3(192 / coarser);
    grid.spacing_mm = glm::dvec3(0.8 * coarser);
    grid.origin_mm = 0.5 * (grid.spacing_mm - box_mm);
    const auto salt = static_cast<std::uint32_t>(seed);
    Canvas canvas(grid, 15.0F, seed);
    paint_tissue(canvas, salt);
    const VesselField vessels(grow_abdominal_arteries(seed), 3.0);
    canvas.paint(
        {}, 2, [&](const glm::vec3& p) { return static_cast<float>(vessels.distance(glm::dvec3(p))); },
        [salt](const glm::vec3& p, float d) {  // slower, and so darker, along the wall
            return 1050.0F - 130.0F * step_between(-1.6F, 0.0F, d) +
                   30.0F * static_cast<float>(gradient_noise(glm::dvec3(p) / 9.0, salt + 3U));
        });
    // Sensitivity of the coil: smooth, stronger at the front.
    canvas.scale([salt](const glm::vec3& p) {
        return 1.0F - 0.0016F * p.y +
               0.18F * static_cast<float>(gradient_noise(glm::dvec3(p) / 95.0, salt + 5U));
    });
    canvas.add_noise(11.0F, salt);
    return canvas.values(ScalarType::u16);
}

}  // namespace viscera::assets
