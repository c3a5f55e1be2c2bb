#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "effects/tissue/baked_surface.h"
#include "effects/tissue/contact.h"
#include "effects/tissue/saved_energy.h"

namespace viscera::tissue {

/// In what distances from a contact are measured.
enum class Metric { world, uv };
[[nodiscard]] std::span<const std::string_view> choice_names(Metric metric);

/// A tile with its contacts, [begin, end) of their list, as glsl/tissue/coagulate.vert reads it. Where they
/// begin is in two parts, since a float rounds numbers above 2^24.
[[nodiscard]] glm::vec4 packed_tile(int x, int y, std::uint32_t begin, std::uint32_t end);

/// A ball outside which nothing changes.
struct LimitParams {
    glm::dvec3 point_mm{0.0};
    double radius_mm = 10.0;

    void visit(ParamVisitor& v);
};

struct CoagulateParams {
    std::optional<SurfaceMeshParams> mesh;
    int size = 512;
    Metric metric = Metric::world;
    std::vector<ContactParams> contacts;
    Gain gain = Gain::peak;
    double max_energy = 1.0;
    double max_speed_mm_s = 1000.0;
    std::optional<LimitParams> limit_to;
    SavedEnergyParams load;

    void visit(ParamVisitor& v);
};

/// Energy that tissue takes up around monopolar contacts: `tissue.energy`, which survives from frame to
/// frame.
class CoagulateEffect final : public Effect {
  public:
    CoagulateEffect();
    ~CoagulateEffect() override;
    void visit(ParamVisitor& visitor) override { params_.visit(visitor); }
    void validate() const override;
    [[nodiscard]] std::vector<Port> ports() const override;
    [[nodiscard]] bool uses_view() const override { return false; }
    [[nodiscard]] std::span<const ProgramDesc> programs() const override { return programs_; }
    [[nodiscard]] Work prepare(Prepare& prepare) override;
    void draw(const Pass& pass) override;

  private:
    static constexpr double no_time = std::numeric_limits<double>::lowest();
    struct Gpu;
    [[nodiscard]] TileTree* find_tiles(Prepare& prepare);
    void find_region(TileTree& tiles, PixelRegion& region);
    void list_tiles(int side, const PixelRegion& region);
    void pack_contacts();
    void draw_tiles(const Pass& pass, std::size_t variant, std::size_t first, std::size_t end);
    void find_limit(const HostValues* values, Log& log);
    void say_unusable(Log& log) const;

    CoagulateParams params_;
    std::vector<ProgramDesc> programs_;
    std::uint64_t parameters_key_ = 0;
    std::shared_ptr<BakedSurface> surface_;
    std::unique_ptr<TileTree> uv_tiles_;  ///< with metric uv, which needs no surface

    std::optional<double> last_time_s_;  ///< of the last frame that was drawn, or had nothing to draw
    double goes_on_s_ = no_time;         ///< time of the loaded state: contacts act from there on
    bool began_ = false;                 ///< the state has been begun; false when it must be begun anew
    ContactList contacts_;
    // What draw() is to do.
    double time_s_ = 0.0;
    const HostValues* values_ = nullptr;  ///< of the frame being drawn
    bool loads_ = false;                  ///< from the saved state, or from nothing when there is none
    glm::vec4 limit_{0.0F};
    std::vector<std::uint32_t> found_;  ///< tiles near one contact
    std::vector<std::uint32_t> pair_tiles_;
    std::vector<std::uint32_t> pair_contacts_;
    std::vector<std::uint32_t> next_;     ///< by tile
    std::vector<glm::vec4> drawn_tiles_;  ///< see packed_tile()
    std::size_t touched_tiles_ = 0;       ///< how many of them, the first ones, contacts reach
    std::vector<glm::vec4> list_;
    std::vector<glm::vec4> packed_;
    std::unique_ptr<Gpu> gpu_;
};

}  // namespace viscera::tissue
