#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/graph.h"
#include "engine/core/params.h"
#include "engine/core/pixel_region.h"
#include "engine/core/shader_source.h"
#include "engine/runtime/frame.h"

namespace viscera {

class Assets;
class Log;
class Pass;
class Prepare;

/// One port of an effect: what it reads or writes, and what that is called when the scene says nothing.
struct Port {
    std::string name;  ///< "main"
    Access access = Access::read;
    std::string target;  ///< default target: "contrast.main"
    std::string doc;     ///< one sentence
    // writes only: what the target is made of, unless the scene says otherwise
    PixelFormat format = PixelFormat::r16f;
    SizeRule size;
    std::array<float, 4> clear{0.0F, 0.0F, 0.0F, 0.0F};
    /// For a read: no fault when nothing writes it. For a write: made only when the scene or another pass
    /// asks for it.
    bool optional = false;
    std::string passthrough;  ///< for a write: the read port that stands in for it while the pass is idle
    /// For a write: draw() sets every pixel of the region, so that nothing need be cleared there before.
    bool overwrites = false;
    /// For a write of colour beside a new depth: draw() sets colour only where it sets a depth below 1. Then
    /// what stays uncovered may get its clear value afterwards, which is less than all.
    bool behind_depth = false;
    bool operator==(const Port&) const = default;
};

/// What there is to do for an effect in one frame.
struct Work {
    enum class Kind { idle, region, update, all };
    Kind kind = Kind::all;
    std::string_view reason;  ///< must outlive the frame: a literal, or a string of the effect's own
    /// region: the part of the target that can differ from its clear value. update: the part that can differ
    /// from what a write's passthrough, or a modify, held before. draw() must set all of it.
    PixelRegion region;
    std::uint64_t key = 0;  ///< hash of all the picture depends on besides its inputs; 0: never reuse it
    std::uint32_t empty_outputs = 0;  ///< bit i: port i of ports() holds nothing but its clear value
    bool goes_on = false;             ///< see go_on()
    bool rests = false;               ///< see rest()
    /// Hash of what the outputs belong to, say a mesh in its place, for Prepare::subject(); 0: to what the
    /// first read that belongs to anything does.
    std::uint64_t subject = 0;

    [[nodiscard]] static Work idle(std::string_view reason) { return {.kind = Kind::idle, .reason = reason}; }
    [[nodiscard]] static Work all(std::uint64_t key) { return {.kind = Kind::all, .key = key}; }
    [[nodiscard]] static Work in_region(const PixelRect& region, std::string_view reason, std::uint64_t key) {
        return {.kind = Kind::region, .reason = reason, .region = region, .key = key};
    }
    /// For targets that survive frames (a `previous` read as the write's passthrough) or go through several
    /// passes: costs by the region, not by the target. draw() must leave alone what lies beside it, between
    /// its rectangles too.
    [[nodiscard]] static Work update(const PixelRegion& region, std::string_view reason, std::uint64_t key) {
        return {.kind = Kind::update, .reason = reason, .region = region, .key = key};
    }
    /// For pictures of which only the GPU knows what has changed: where Pass::kept() says that the targets
    /// still hold what this pass drew last, they are not cleared, and draw() changes what is to change.
    [[nodiscard]] static Work go_on(std::uint64_t key) {
        return {.kind = Kind::all, .key = key, .goes_on = true};
    }
    /// As go_on(), and nothing has changed since the key was drawn: the pass is reported as idle, unless the
    /// picture is lost and must be drawn again.
    [[nodiscard]] static Work rest(std::string_view reason, std::uint64_t key) {
        return {.kind = Kind::all, .reason = reason, .key = key, .goes_on = true, .rests = true};
    }
};

/// One step of a picture. Everything but draw() is free of OpenGL and may run without a context.
class Effect {
  public:
    Effect() = default;
    Effect(const Effect&) = delete;
    Effect& operator=(const Effect&) = delete;
    virtual ~Effect() = default;

    /// Visits the parameters; readers fill them. Called before anything else.
    virtual void visit(ParamVisitor& visitor) = 0;
    /// Checks what single ranges cannot: combinations of parameters. Throws Error(scene) with a JSON pointer
    /// relative to the parameters as `where`.
    virtual void validate() const {}
    /// Ports under the present parameters.
    [[nodiscard]] virtual std::vector<Port> ports() const = 0;
    /// Whether prepare() or draw() look at Frame::eye(): such a pass runs once per eye, in an object of its
    /// own for each; another runs once for both unless it reads what differs from eye to eye. An effect that
    /// says no is given frames without an eye.
    [[nodiscard]] virtual bool uses_view() const { return true; }
    /// Whether what it draws builds on frames before by more than its `previous` ports: by a state that it
    /// shares.
    [[nodiscard]] virtual bool keeps_state() const { return false; }
    /// Every program that draw() may use under the present parameters, so that all can be validated without a
    /// GPU.
    [[nodiscard]] virtual std::span<const ProgramDesc> programs() const = 0;
    /// What there is to do this frame. No OpenGL. Reads no asset unless something is to be drawn.
    [[nodiscard]] virtual Work prepare(Prepare& prepare) = 0;
    /// Draws into the targets that are bound. The only place with OpenGL.
    virtual void draw(const Pass& pass) = 0;
};

/// What prepare() may look at.
class Prepare {
  public:
    virtual ~Prepare() = default;
    [[nodiscard]] virtual const Frame& frame() const = 0;
    [[nodiscard]] virtual Assets& assets() = 0;
    [[nodiscard]] virtual Log& log() = 0;
    /// Changes whenever the effect's parameters do.
    [[nodiscard]] virtual std::uint64_t parameters_key() const = 0;
    /// Whether a port has content this frame: false for a read that nothing writes or whose writer is idle,
    /// and for a write that nobody needs.
    [[nodiscard]] virtual bool has(std::string_view port) const = 0;
    /// What a port's content belongs to, as its writer has said this frame (Work::subject); 0: unknown. With
    /// it a reader tells a target that was made for another thing than its own.
    [[nodiscard]] virtual std::uint64_t subject(std::string_view port) const = 0;
    /// Another one whenever what a port reads may be another picture; 0 where it has no content.
    [[nodiscard]] virtual std::uint64_t content(std::string_view port) const = 0;
    /// Size of a port's target [pixels]; {0, 0} for an unbound port.
    [[nodiscard]] virtual glm::ivec2 size(std::string_view port) const = 0;
};

/// Effects by name. Each entry is a factory, so that one scene may use an effect many times.
class Registry {
  public:
    using Factory = std::function<std::unique_ptr<Effect>()>;
    struct Entry {
        std::string name;  ///< "contrast.summarize"
        std::string doc;   ///< one sentence
        Factory make;
    };

    /// Throws Error(usage) when the name is taken.
    void add(std::string name, std::string doc, Factory make);
    [[nodiscard]] const Entry* find(std::string_view name) const;
    [[nodiscard]] std::span<const Entry> entries() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

}  // namespace viscera
