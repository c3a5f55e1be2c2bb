#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/blood_seams.h"
#include "effects/tissue/list_texture.h"
#include "engine/core/shader_source.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// A drop to be, as the shader reads it: two texels.
struct DropSpawn {
    glm::vec2 uv{0.0F};
    float volume_mm3 = 0.0F;
    float radius_mm = 0.0F;  ///< of the place around `uv` in which it appears
    float slot = 0.0F;       ///< in the ring
    float seed = 0.0F;
    /// UV of the tissue that decides whether it comes; negative: the place in which it appears does.
    glm::vec2 sealed_at{-1.0F};
};

/// What the steps of one frame have in common, as the shaders want it.
struct BloodMedium {
    glm::vec4 flow{0.0F};  ///< mobility [1/(mm s)], residual [mm], time step [s], drying [mm/s]
    glm::vec4 drop{0.0F};  ///< aspect, trail [mm], life [s], smallest volume [mm^3]
    glm::vec3 down{0.0F};
    float strength = 0.0F;   ///< of gravity, in units of the standard one
    float spreading = 0.0F;  ///< see GravityParams
    float sealed_energy = 1.0F;
    bool open_edges = true;
    std::vector<glm::vec4> tools;        ///< place [mm], radius [mm]
    std::vector<glm::vec2> tool_powers;  ///< see tool_power()
};

/// Drops [first, first + count) of the ring.
struct DropRange {
    std::int64_t first = 0;
    std::int64_t count = 0;
};

/// Blocks are drawn as points as large as they are.
inline constexpr gl::RasterState cover_state{.program_point_size = true};

/// Film, drops and tiles on the GPU, and the passes that step them. All of it is bound to the size of the
/// bake and to a number of drops. Every function draws into framebuffers of its own and leaves one of them
/// bound.
class BloodGpu {
  public:
    BloodGpu(const gl::Functions& gl, int size, int max_drops);

    /// Programs that the functions below use, in the order that they expect.
    [[nodiscard]] static std::vector<ProgramDesc> programs();

    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] std::int64_t capacity() const;

    /// The surface is new or has moved, or gravity has turned. `empty`: nothing lies on it yet.
    void take_surface(const Pass& pass, const BloodMedium& medium, bool empty);
    /// Seams of another surface: reads the bake back, once.
    void find_seams(const Pass& pass);
    /// Looks which tiles have come to rest and which are to be stepped from now on.
    void look_at_tiles(const Pass& pass, const BloodMedium& medium, const DropRange& alive, bool wake);
    /// New drops; those that stood at their places become film first.
    void spawn(const Pass& pass, const BloodMedium& medium, std::span<const DropSpawn> drops,
               const DropRange& evicted);
    void step(const Pass& pass, const BloodMedium& medium, const DropRange& alive, std::int64_t step);
    /// What the picture of the blood holds before it is drawn.
    enum class Shown {
        last,     ///< what was drawn before the last end_picture()
        nothing,  ///< its clear value
        unknown,
    };
    /// Finds how high the blood stands.
    void begin_picture(const Pass& pass, const BloodMedium& medium, const DropRange& alive, Shown before);
    /// Height of film and drops [mm], -1 where there is no surface.
    [[nodiscard]] const gl::Texture& relief() const { return relief_; }
    /// Draws over each block whose look may have changed, in cover_state, with the program in use and into
    /// what is bound.
    void cover_changed(const Pass& pass, const gl::Program& program, Shown before) const;
    /// The picture has been drawn: changes count from now on.
    void end_picture(const Pass& pass) const;

    /// Asks which tiles are to be stepped; the answer comes some frames later with the tag.
    void ask_tiles(std::uint64_t tag);
    /// The tag of an answer that says that no tile is, if one has come.
    [[nodiscard]] std::optional<std::uint64_t> all_still();

    [[nodiscard]] const gl::Texture& film() const { return film_[film_now_]; }
    [[nodiscard]] const gl::Texture& drops() const { return drops_[drops_now_]; }
    [[nodiscard]] const gl::Texture& ledger() const { return ledger_; }

  private:
    void bind_place(const Pass& pass, const gl::Program& program) const;
    void set_medium(const gl::Program& program, const BloodMedium& medium) const;
    void set_tools(const Pass& pass, const gl::Program& program, const BloodMedium& medium) const;
    void cover_tiles(const Pass& pass, const gl::Program& program) const;
    void deposit(const Pass& pass, const BloodMedium& medium, const DropRange& range,
                 const gl::Texture& source, bool whole, std::int64_t step) const;
    void mark_pairs(const Pass& pass, const SeamPairs& pairs, const gl::Texture& marked,
                    const gl::Framebuffer& target) const;
    void reach_from_tiles(const Pass& pass) const;
    void note_stepped(const Pass& pass) const;
    void mark_drops(const Pass& pass, const BloodMedium& medium, const DropRange& range,
                    bool blockwise) const;
    void plan(const Pass& pass, const BloodMedium& medium, const DropRange& alive) const;
    void draw_rows(const Pass& pass, const DropRange& range) const;

    const gl::Functions* gl_;
    int size_ = 0;
    int tiles_ = 0;   ///< along each side
    int blocks_ = 0;  ///< along each side
    std::array<gl::Texture, 2> film_;
    std::array<gl::Texture, 2> drops_;
    gl::Texture deposit_;
    std::array<gl::Texture, 2> marks_;   ///< of tiles: changed, visible
    std::array<gl::Texture, 2> across_;  ///< of tiles: beyond a seam from marked ones
    gl::Texture reach_;                  ///< of tiles: marked or beside marked ones
    std::array<gl::Texture, 2> held_;    ///< of blocks: holds blood, changed, shows blood
    gl::Texture beyond_;                 ///< of blocks: beyond a seam from those that hold blood
    std::array<gl::Texture, 2>
        plan_;             ///< of blocks: to be stepped, to be shown; now and before the last look
    gl::Texture stepped_;  ///< of blocks: stepped since the picture was drawn, up to the last look
    gl::Texture relief_;
    ListTexture spawn_;
    gl::Texture ledger_;  ///< volume given [mm^3], in parts
    std::optional<BloodSeams> seams_;
    std::array<gl::Framebuffer, 2> film_target_;
    std::array<gl::Framebuffer, 2> drops_target_;  ///< with the deposit
    std::array<gl::Framebuffer, 2> drops_alone_;
    std::array<gl::Framebuffer, 2> marks_target_;
    std::array<gl::Framebuffer, 2> across_target_;
    std::array<gl::Framebuffer, 2> held_target_;
    gl::Framebuffer reach_target_;
    gl::Framebuffer beyond_target_;
    std::array<gl::Framebuffer, 2> plan_target_;
    gl::Framebuffer stepped_target_;
    gl::Framebuffer relief_target_;
    bool relief_known_ = false;
    gl::Framebuffer ledger_target_;
    std::size_t film_now_ = 0;
    std::size_t drops_now_ = 0;
    std::size_t marks_now_ = 0;
    std::vector<glm::vec4> spawn_items_;
    gl::ReadBack tile_answers_;
};

}  // namespace viscera::tissue
