#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "effects/tissue/blood_medium.h"
#include "effects/tissue/blood_programs.h"
#include "effects/tissue/drop_groups.h"
#include "effects/tissue/list_texture.h"
#include "effects/tissue/seam_links.h"
#include "engine/core/image.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// Which parts of a film are stepped, known on the GPU alone: tiles in which nothing changes rest, and of
/// the others only those blocks are stepped that blood may reach before the next plan. All functions but
/// the drawing ones leave a framebuffer of their own bound.
class BloodBlocks {
  public:
    static constexpr int block_side = 8;  ///< [texels]; as blood_plan.glsl
    /// Between two looks at which tiles are at rest: in as many steps no film leaves the blocks around its
    /// own.
    static constexpr int steps_per_look = block_side;
    /// A drop moves two texels in a step at most, and the film that it leaves one: blood_mark.vert.
    static constexpr int steps_per_plan = 4;
    static constexpr int in_row = 16;  ///< blocks in each of rows(); as blood_ground.glsl

    /// Film and drops as they are now.
    struct Blood {
        const gl::Texture& film;
        const gl::Texture& film_before;  ///< one step ago
        const gl::Texture& drops;
        const DropGroups& groups;
    };
    enum class Drawn {
        beside_no_seam,  ///< to be stepped, with cells, none of them at a seam
        at_seams,        ///< to be stepped, the others with cells
        gutters,         ///< of which nothing but gutters changes, beside those that a step needs
        settled,         ///< stepped until the last look
    };

    /// `size`: texels along each side of the film.
    BloodBlocks(const gl::Functions& gl, int size);

    /// The surface is another.
    void lie_on(const Image& position, std::span<const SeamLink> links, std::span<const SeamJump> jumps);
    /// Blocks with a surface: x, y each. Those with cells first, and of these those beside no seam; then
    /// those with gutters beside cells, which a step reads, and those with gutters that are only seen.
    [[nodiscard]] const gl::Texture& list() const { return list_.texture(); }
    /// That textures have which lay down by blocks what belongs to them, in the order of the list.
    [[nodiscard]] int rows() const { return std::max((listed_ + in_row - 1) / in_row, 1); }
    /// Nothing is known yet; `everywhere`: blood may be anywhere.
    void begin(const Pass& pass, bool everywhere);
    /// Where drops may appear before the next look: UV, the volume of a drop as large as the place, and the
    /// radius around the UV in which they do [mm]. Where all of that is sealed by energy nothing is stepped.
    void expect(std::span<const glm::vec4> places);
    /// Finds out what has happened in each block. `wake`: whatever shows blood is to be stepped.
    void look(const Pass& pass, const BloodMedium& medium, const Blood& blood, bool wake);
    /// New drops are where no plan has looked.
    void drops_came();
    /// Drops leave their blood where they are, and no longer live.
    void drops_end(const Pass& pass, const BloodMedium& medium, const Blood& blood, const DropRange& drops);
    /// Plans if there was a look, and `for_step`, before each step, if drops may have left what is planned.
    /// Returns whether blocks may have settled.
    [[nodiscard]] bool plan(const Pass& pass, const BloodMedium& medium, const Blood& blood, bool for_step);

    /// Draws over blocks with a program in use whose vertex shader is blood_tile.vert.
    void cover(const Pass& pass, const gl::Program& program, Drawn drawn) const;
    /// Blocks stepped since the last picture; `whole`: all that show blood. `only_seen`: those with gutters
    /// that no step reads.
    void cover_changed(const Pass& pass, const gl::Program& program, bool whole,
                       bool only_seen = false) const;
    void bind_plan(const Pass& pass, const gl::Program& program) const;
    /// The picture is unlike all before.
    void forget_picture(const Pass& pass);
    void end_picture(const Pass& pass);

    /// Asks which tiles are to be stepped; the answer comes some frames later with the tag.
    void ask(std::uint64_t tag);
    /// The tag of an answer that says that no tile is, if one has come.
    [[nodiscard]] std::optional<std::uint64_t> all_still();

  private:
    /// Puts a program in use that marks the blocks that its drops reach, and binds these.
    [[nodiscard]] const gl::Program& begin_mark(const Pass& pass, const BloodMedium& medium,
                                                BloodShader shader, const gl::Texture& drops) const;
    void mark_alive(const Pass& pass, const BloodMedium& medium, const Blood& blood) const;
    void reach(const Pass& pass) const;
    /// Of list(): the first, and one past the last.
    [[nodiscard]] std::pair<int, int> range_of(Drawn drawn) const;
    void draw(const Pass& pass, const gl::Program& program, int first, int last) const;

    const gl::Functions* gl_;
    int size_ = 0;
    int tiles_ = 0;     ///< along each side
    int blocks_ = 0;    ///< along each side
    ListTexture list_;  ///< see list()
    int listed_ = 0;
    int without_seams_ = 0;
    int with_cells_ = 0;
    int stepped_blocks_ = 0;    ///< all but those that are only seen
    ListTexture tiles_across_;  ///< by the tile that is reached: see blood_reach.frag
    gl::Texture first_tile_;
    ListTexture block_pairs_;  ///< by the block that is reached: see blood_across.frag
    gl::Texture first_pair_;
    ListTexture expected_;
    int expected_count_ = 0;
    gl::Texture surface_;              ///< of blocks: there is one
    gl::Texture marks_;                ///< of tiles: changed, visible
    gl::Texture reach_;                ///< of tiles: marked or beside marked ones
    std::array<gl::Texture, 2> held_;  ///< of blocks: blood (blood_held.glsl), changed, shows blood
    gl::Texture near_;                 ///< of blocks: in reach of blood within their chart
    std::array<gl::Texture, 2> plan_;  ///< of blocks: to be stepped, to be shown; now, before the last look
    gl::Texture stepped_;  ///< of blocks: stepped since the picture was drawn, up to the last look
    gl::Framebuffer marks_target_;
    gl::Framebuffer reach_target_;
    std::array<gl::Framebuffer, 2> held_target_;
    gl::Framebuffer near_target_;
    std::array<gl::Framebuffer, 2> plan_target_;
    gl::Framebuffer stepped_target_;
    std::size_t now_ = 0;
    int steps_planned_ = 0;  ///< steps for which the plan still holds
    bool looked_ = false;    ///< since the plan
    bool tiles_old_ = true;  ///< since then there was a look, or drops came
    bool noted_ = false;     ///< stepped_ holds something
    gl::ReadBack answers_;
};

}  // namespace viscera::tissue
