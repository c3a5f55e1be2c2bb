#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/schedule.h"
#include "engine/gl/capabilities.h"
#include "engine/gl/timer.h"
#include "engine/runtime/eye_scene.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/report.h"
#include "engine/runtime/target_pool.h"

namespace viscera {

/// Runs a plan: asks each effect what there is to do, decides what need not be done, and draws the rest in
/// order. Knows no effect and no file.
class Executor {
  public:
    struct Options {
        bool timers = true;
        bool check_errors = true;
        PassObserver observer;
        bool fill_after = false;  ///< what lies behind depth is cleared after drawing: Port::behind_depth
    };

    Executor(const Pass::Shared& shared, const gl::Capabilities& capabilities, Options options);

    /// Takes a compiled graph and the effects of its passes, which must outlive it. Targets of the same size
    /// are kept, their content is not, unless it is the last frame's and the scene the same as before.
    void set_plan(Plan plan, std::vector<ImportedTarget> imported, std::span<const PassEffect> effects,
                  bool same_scene);
    /// Takes another effect of the same kind and ports for all passes of this origin: its parameters have
    /// changed. All that is held stays.
    void replace_effect(const PassEffect& effect);

    /// Draws one frame and fills the report's passes. On an exception nothing counts as held any more but
    /// what the frames before left to be seen as `previous`.
    void run(const Frame& frame, FrameReport& report);

    [[nodiscard]] const Plan& plan() const { return plan_; }
    /// Content of an output in the frame just run: its texture, or null when it holds nothing but `clear`.
    struct Output {
        const gl::Texture* texture = nullptr;
        const PlanContent* content = nullptr;
        std::uint64_t key = 0;  ///< names what it holds: equal keys, equal pixels
        bool imported = false;  ///< the texture is the host's, who may change it after the frame
    };
    [[nodiscard]] std::optional<Output> output(std::string_view name) const;
    /// Outside of this, content `newer` is as `older` (Output::key); none: not known.
    [[nodiscard]] std::optional<PixelRegion> changed(std::uint64_t older, std::uint64_t newer) const {
        return schedule_.changed(older, newer);
    }
    /// To read an output's texture, of colour, through; valid until the next frame.
    [[nodiscard]] const gl::Framebuffer& framebuffer(const Output& output) {
        return pool_.framebuffer(std::span(&output.texture, 1), nullptr, "watched target");
    }
    /// Gives away the texture of an output; 0 where it is empty or imported. The frame's other targets are
    /// then drawn anew, too.
    [[nodiscard]] GLuint release(std::string_view name);

  private:
    class FramePrepare;
    struct PassState {
        Effect* effect = nullptr;
        std::uint64_t parameters_key = 0;
        EyePass origin;
        std::size_t frame = 0;  ///< which of frames_ the effect sees
        std::vector<Port> ports;
        std::vector<std::size_t> port_of_binding;
        std::vector<ShaderLibrary::Entry*> programs;
        std::vector<Pass::Input> inputs;
        std::vector<Pass::Output> outputs;
        std::vector<const gl::Texture*> colours;
        std::vector<std::uint64_t> drawn_keys;  ///< by binding: the content that it drew last
        std::unique_ptr<gl::GpuTimer> timer;
        Work work;
    };

    void find_programs(PassState& state) const;
    void see(const Frame& frame);
    void prepare(FrameReport& report);
    void pass_on_subject(const PlanPass& pass, std::uint64_t subject);
    /// True when it was done by a compute shader.
    bool draw(std::size_t pass);
    void settle(const Settlement& settlement);
    void turn_over();
    void forget_frame();
    void import(const Frame& frame);
    void check(std::string_view pass, std::span<ShaderLibrary::Entry* const> programs) const;
    void observe(std::string_view pass, bool begins) const;
    [[nodiscard]] const gl::Texture& texture_of(std::size_t content) const;
    /// What has been cleared before a pass draws, and what still has to be afterwards.
    struct Cleared {
        bool kept = false;    ///< nothing was cleared, since all goes on from what the pass drew last
        PixelRect uncovered;  ///< what is cleared afterwards, where nothing was drawn
        std::array<float, 4> value{};
    };
    [[nodiscard]] Cleared clear(PassState& state, const PlanPass& pass, const gl::Framebuffer& target,
                                const PixelRegion& region);
    [[nodiscard]] bool holds_last(const PassState& state, const PlanPass& pass);
    [[nodiscard]] bool fills_after(const PassState& state, const PlanPass& pass, std::size_t binding) const;
    [[nodiscard]] bool is_new(const PassState& state, const PlanBinding& binding) const;
    void fill(const gl::Framebuffer& target, const Cleared& cleared) const;
    [[nodiscard]] bool costs_all(const gl::Framebuffer& target, std::int64_t area) const;
    void clear_outside(const gl::Framebuffer& target, int index, const std::array<float, 4>& value,
                       const PixelRect& part, const PixelRect& set) const;
    void clear_part(const gl::Framebuffer& target, int index, const std::array<float, 4>& value,
                    const PixelRect& part) const;

    Pass::Shared shared_;
    const gl::Capabilities& capabilities_;
    Options options_;
    Plan plan_;
    std::vector<ImportedTarget> imported_;
    std::vector<gl::Texture> imported_textures_;
    std::vector<std::uint64_t> imported_keys_;
    TargetPool pool_;
    ShaderLibrary::Entry& fill_program_;
    Schedule schedule_;
    std::vector<PassState> passes_;
    std::vector<std::uint64_t> subjects_;  ///< by content, of this frame
    /// The frame as effects are given it: without an eye, by the left or only one, by the right one.
    std::array<Frame, 3> frames_;
    bool ran_ = false;  ///< a frame has been drawn whose history has not turned over yet
};

}  // namespace viscera
