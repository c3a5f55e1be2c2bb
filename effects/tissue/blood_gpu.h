#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/blood_blocks.h"
#include "effects/tissue/blood_ground.h"
#include "effects/tissue/blood_jumps.h"
#include "effects/tissue/blood_medium.h"
#include "effects/tissue/blood_seams.h"
#include "effects/tissue/list_texture.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/program.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// Film and drops on the GPU, and the passes that step them. All of it is bound to the size of the bake and
/// to a number of drops. Every function draws into framebuffers of its own and leaves one of them bound.
///
/// The passes in their order, by the names of their shaders:
/// take_surface():  start (areas of cells), ground and faces (what the film reads, block by block), jump
/// (where
///                  gutters lead), link (what drives a film across seams)
/// look_at_tiles(): lives (which drops live, for the CPU), search (what each block of 8 x 8 texels holds)
/// plan():          mark (blocks that drops reach), scan and reach (tiles of 32 x 32 that stir, and those
/// beside
///                  them), near (blocks that blood may reach), across (those across seams), settle (blocks
///                  that are no longer stepped become alike in both textures); after a look, and every few
///                  steps
/// spawn():         deposit of drops that must make room, spawn
/// step():          plan(), move (drops), film (and what comes across seams), gutter, deposit (what drops
/// leave) begin_picture(): plan(), gutter (those that no step reads), cap (drops); then the effect draws the
/// look
class BloodGpu {
  public:
    BloodGpu(const gl::Functions& gl, int size, int max_drops);

    [[nodiscard]] std::int64_t capacity() const { return groups_.capacity(); }

    /// The surface is new or has moved, or gravity has turned. `empty`: nothing lies on it yet.
    void take_surface(const Pass& pass, const BloodMedium& medium, bool empty);
    /// Seams of another surface: reads the bake back, once.
    void find_seams(const Pass& pass);
    /// Where drops may appear before the next look: see BloodBlocks.
    void expect(std::span<const glm::vec4> places) { blocks_.expect(places); }
    /// Looks what has come to rest and what is to be stepped from now on.
    void look_at_tiles(const Pass& pass, const BloodMedium& medium, DropRing& ring, bool wake);
    /// New drops; those that stood at their places become film first.
    void spawn(const Pass& pass, const BloodMedium& medium, std::span<const DropSpawn> drops,
               const DropRange& evicted);
    void step(const Pass& pass, const BloodMedium& medium, DropRing& ring, std::int64_t step);
    /// What the picture of the blood holds before it is drawn.
    enum class Shown {
        last,     ///< what was drawn before the last end_picture()
        nothing,  ///< its clear value
        unknown,
    };
    /// Finds how high the blood stands.
    void begin_picture(const Pass& pass, const BloodMedium& medium, Shown before);
    /// Draws over each block whose look may have changed, with the program in use and into what is bound.
    void cover_changed(const Pass& pass, const gl::Program& program, Shown before) const;
    /// The picture has been drawn: changes count from now on.
    void end_picture(const Pass& pass) { blocks_.end_picture(pass); }

    /// Asks which tiles are to be stepped; the answer comes some frames later with the tag.
    void ask_tiles(std::uint64_t tag) { blocks_.ask(tag); }
    /// The tag of an answer that says that no tile is, if one has come.
    [[nodiscard]] std::optional<std::uint64_t> all_still() { return blocks_.all_still(); }

    [[nodiscard]] const gl::Texture& film() const { return film_[film_now_]; }
    [[nodiscard]] const gl::Texture& drops() const { return drops_[drops_now_]; }
    [[nodiscard]] const gl::Texture& ledger() const { return ledger_; }

  private:
    [[nodiscard]] BloodBlocks::Blood blood() const;
    void plan(const Pass& pass, const BloodMedium& medium, bool for_step);
    void bind_place(const Pass& pass, const gl::Program& program, const gl::Texture& film) const;
    void set_medium(const gl::Program& program, const BloodMedium& medium) const;
    void set_tools(const Pass& pass, const gl::Program& program, const BloodMedium& medium) const;
    /// After move_drops(): lays down what drops have lost in it.
    void deposit(const Pass& pass, const BloodMedium& medium, std::int64_t step) const;
    void give_up(const Pass& pass, const BloodMedium& medium, const DropRange& evicted) const;
    [[nodiscard]] const gl::Program& use_deposit(const Pass& pass, const BloodMedium& medium,
                                                 BloodShader shader, const gl::Texture& drops,
                                                 const gl::Texture& areas) const;
    void move_drops(const Pass& pass, const BloodMedium& medium);
    void step_cells(const Pass& pass, const BloodMedium& medium, BloodShader shader,
                    BloodBlocks::Drawn drawn) const;
    void step_film(const Pass& pass, const BloodMedium& medium) const;

    const gl::Functions* gl_;
    int size_ = 0;
    BloodBlocks blocks_;
    BloodGround ground_;
    std::array<gl::Texture, 2> film_;
    /// Height of film and drops [mm], -1 where there is no surface: of the film as it was stepped last, of
    /// drops as they were drawn last.
    gl::Texture relief_;
    DropGroups groups_;
    std::array<gl::Texture, 2> drops_;
    gl::Texture deposit_;
    ListTexture spawn_;
    gl::Texture ledger_;  ///< volume given [mm^3], by the place of its drops in the ring
    std::optional<BloodSeams> seams_;
    std::optional<BloodJumps> jumps_;
    std::array<gl::Framebuffer, 2> film_target_;   ///< with the relief
    std::array<gl::Framebuffer, 2> drops_target_;  ///< with the deposit
    std::array<gl::Framebuffer, 2> spawn_target_;  ///< with the ledger
    gl::Framebuffer relief_target_;
    std::size_t film_now_ = 0;
    std::size_t drops_now_ = 0;
    std::vector<glm::vec4> spawn_items_;
};

}  // namespace viscera::tissue
