#include "assets/generate/volume_artery.h"

#include <array>
#include <cmath>
#include <numbers>

#include "assets/generate/noise.h"
#include "assets/generate/ultrasound_echo.h"
#include "assets/generate/volume_solids.h"

namespace viscera::assets {
namespace {

using std::numbers::pi;
constexpr double length_mm = 24.0;
constexpr double plaque_side = 0.6;  // its middle [rad]
constexpr double branch_side = 3.6;
constexpr double grains_around = 180.0;

/// 1 at the middle, 0 from `half` mm on.
double bump(double x, double middle, double half) {
    const double t = std::clamp(std::abs(x - middle) / half, 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

/// Angle from another, [-pi, pi].
double apart(double angle, double from) {
    return std::remainder(angle - from, 2.0 * pi);
}

/// What lies at a place, as its depths behind the layers' faces [mm].
struct Wall {
    double lumen = 0.0;   ///< < 0 in the blood
    double media = 0.0;   ///< < 0 inside of the media
    double branch = 0.0;  ///< < 0 in the branch
    double plaque_mm = 0.0;
    double side = 0.0;  ///< angle from the plaque's middle
};

class Artery {
  public:
    explicit Artery(std::uint32_t seed) : seed_(seed) {}

    [[nodiscard]] Wall at(double radius, double angle, double z) const {
        // The catheter, at the origin, lies off the middle and away from the plaque.
        const glm::dvec2 middle(0.5 * std::cos(plaque_side) + 0.18 * std::sin(0.35 * z),
                                0.5 * std::sin(plaque_side) + 0.18 * std::cos(0.27 * z));
        const glm::dvec2 q = radius * glm::dvec2(std::cos(angle), std::sin(angle)) - middle;
        const double around = std::atan2(q.y, q.x);
        const glm::dvec3 rough(3.0 * std::cos(around), 3.0 * std::sin(around), 0.6 * z);
        Wall wall;
        wall.side = apart(around, plaque_side);
        wall.plaque_mm = 1.3 * bump(z, 13.0, 8.0) * std::pow(std::max(0.0, std::cos(0.62 * wall.side)), 2.0);
        const double media =
            2.45 - 0.012 * z + 0.15 * bump(z, 13.0, 8.0) + 0.05 * gradient_noise(rough, seed_);
        const double intima = 0.16 + wall.plaque_mm + 0.05 * gradient_noise(2.0 * rough, seed_ + 1U);
        wall.media = glm::length(q) - media;
        wall.branch = branch_distance(q, z);
        wall.lumen = std::min(glm::length(q) - (media - intima), wall.branch);
        return wall;
    }

    /// [dB], and what of it every place behind loses.
    [[nodiscard]] double echo(const Wall& wall, double z) const {
        if (wall.lumen < 0.0) {
            return -47.0;  // blood
        }
        if (is_calcified(wall, z)) {
            return 2.0;
        }
        if (wall.lumen < 0.1) {
            return -11.0;  // intima
        }
        if (wall.branch < 0.25) {
            return -17.0;
        }
        if (wall.media < 0.0) {
            const bool lipid =
                wall.plaque_mm > 0.5 && wall.lumen > 0.3 && z < 12.0 && std::abs(wall.side) < 0.9;
            return lipid ? -36.0 : -19.0;
        }
        return wall.media < 0.2 ? -42.0 : -9.0 - 5.0 * (wall.media - 0.2);  // media, adventitia
    }

    [[nodiscard]] bool is_calcified(const Wall& wall, double z) const {
        return wall.plaque_mm > 0.4 && std::abs(z - 15.5) < 2.5 && std::abs(wall.side) < 0.65 &&
               wall.lumen > 0.2 && wall.lumen < 0.5;
    }

  private:
    /// To a tube that leaves the artery and bends downstream.
    static double branch_distance(const glm::dvec2& q, double z) {
        const glm::vec3 p(q, z);
        const glm::vec3 out(std::cos(branch_side), std::sin(branch_side), 0.0F);
        return static_cast<double>(rod(p, glm::vec3(0.0F, 0.0F, 4.2F) + 1.2F * out,
                                       glm::vec3(0.0F, 0.0F, 7.5F) + 6.0F * out, 0.85F, 0.8F));
    }

    std::uint32_t seed_;
};

}  // namespace

Volume make_artery(std::uint64_t seed, int coarser) {
    Volume volume{.type = ScalarType::u8, .voxels = {}};
    VolumeGrid& grid = volume.grid;
    grid.dims = glm::ivec3(112, 256, 72) / coarser;
    grid.shape = {.kind = VolumeKind::cylindrical,
                  .r_min_mm = 0.5,
                  .r_max_mm = 5.0,
                  .angle_rad = 2.0 * pi,
                  .wrap = true,
                  .height_mm = length_mm};
    grid.origin_mm = {0.0, 0.0, -0.5 * length_mm};
    const double radius_step = 4.5 / (grid.dims.x - 1);
    const double angle_step = 2.0 * pi / grid.dims.y;
    const double height_step = length_mm / (grid.dims.z - 1);
    grid.spacing_mm = {radius_step, 2.75 * angle_step, height_step};  // for programs that show it unrolled
    const auto salt = static_cast<std::uint32_t>(seed);
    const Artery artery(salt);
    for (int k = 0; k < grid.dims.z; ++k) {
        const double z = k * height_step;
        for (int j = 0; j < grid.dims.y; ++j) {
            const double angle = j * angle_step;
            const bool wire = std::abs(apart(angle, 2.2 + 0.03 * z)) < 0.06;
            double lost_db = 0.0;
            for (int i = 0; i < grid.dims.x; ++i) {
                const double radius = 0.5 + i * radius_step;
                const Wall wall = artery.at(radius, angle, z);
                const bool on_wire = wire && radius > 0.68 && radius < 0.84;
                const double echo = on_wire ? 0.0 : artery.echo(wall, z);
                const glm::dvec3 grain(radius / 0.09, grains_around * angle / (2.0 * pi), z / 0.5);
                volume.voxels.push_back(
                    gray_of(echo - lost_db, speckle_around(grain, grains_around, salt + 7U)));
                lost_db += radius_step * (on_wire ? 90.0 : artery.is_calcified(wall, z) ? 160.0 : 0.0);
            }
        }
    }
    return volume;
}

}  // namespace viscera::assets
