#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/image.h"

namespace viscera {
class Renderer;
struct WatchedTarget;
}  // namespace viscera

namespace viscera::tissue {

/// Names of the targets that are asked: the energy, and the bake's positions and metric.
struct EnergyTargets {
    std::string energy = "tissue.energy";
    std::string position = "tissue.position";
    std::string metric = "tissue.metric";
};

/// What a simulator's logic asks of burnt tissue, answered from copies in memory: never by waiting for the
/// GPU. Answers are as old as the copies are: frames_behind(). After Renderer::set_scene there are none until
/// copies of that scene have come.
///
///     renderer.watch(EnergyQueries::targets());
///     ... each frame: renderer.render(frame); queries.update(renderer); queries.energy_at(uv) ...
class EnergyQueries {
  public:
    /// Other names than those above, where the scene's passes give them to their targets.
    explicit EnergyQueries(EnergyTargets names = {});
    /// What is to be watched.
    [[nodiscard]] static std::vector<std::string> targets(const EnergyTargets& names = {});

    /// Takes the latest copies of a renderer. False: none have arrived yet, and there are no answers; those
    /// of a scene before are forgotten. With `most_frames_behind` it waits for copies that are no older
    /// (Renderer::wait_for_watched).
    bool update(Renderer& renderer, std::optional<std::uint64_t> most_frames_behind = std::nullopt);
    /// The same from pictures: energy of one channel, position and metric as the bake describes them, all of
    /// one size. Throws Error(usage) when they are not.
    void take_surface(const Image& position, const Image& metric);
    void take_energy(const Image& energy);

    /// Frames that have been rendered since the one that answers are right for, that of the oldest of the
    /// three copies: 0 or 1, more only while the GPU itself is behind. Without answers 0.
    [[nodiscard]] std::uint64_t frames_behind() const { return frames_behind_; }
    /// Time of that frame [s]. Without answers 0.
    [[nodiscard]] double time_s() const { return time_s_; }

    /// Energy at a place of the texture, interpolated as shaders do; none where there is no surface, or
    /// nothing is known yet.
    [[nodiscard]] std::optional<double> energy_at(const glm::dvec2& uv) const;
    /// Energy of the texel whose centre lies nearest to a point [mm in the world]; none when it is farther
    /// away than `within_mm`.
    [[nodiscard]] std::optional<double> energy_at(const glm::dvec3& point_mm, double within_mm) const;
    /// Surface [mm^2] with an energy of at least `threshold`, which is above 0. Without answers 0.
    [[nodiscard]] double coagulated_area(double threshold) const;
    /// Surface [mm^2] with an energy below 0.
    [[nodiscard]] double dissected_area() const;

  private:
    static constexpr int tile_texels = 16;
    struct Box {
        glm::vec3 low{1e30F};
        glm::vec3 high{-1e30F};
    };
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    template <class Counts>
    [[nodiscard]] double area(Counts counts) const;
    void take(const std::array<const WatchedTarget*, 3>& copies);
    void forget();
    void nearest_in_tile(std::size_t tile, const glm::vec3& point, float& distance2,
                         std::size_t& texel) const;

    std::array<std::string, 3> names_;
    int width_ = 0;                  ///< [texels]
    int height_ = 0;                 ///< [texels]
    std::vector<glm::vec4> places_;  ///< by texel: world [mm], coverage
    std::vector<float> areas_;       ///< by texel [mm^2]; 0 in gutters
    std::vector<float> energies_;    ///< by texel
    std::vector<Box> boxes_;         ///< by tile
    int tiles_x_ = 0;
    std::array<std::uint64_t, 3> versions_{};  ///< of the copies that were taken
    std::uint64_t frames_behind_ = 0;
    double time_s_ = 0.0;
};

}  // namespace viscera::tissue
