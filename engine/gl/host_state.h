#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/log.h"
#include "engine/gl/host_state_rows.h"

namespace viscera::gl {

/// The context state of a host, kept while the engine draws in the host's context.
///
/// Kept is what the rows of host_state_rows.h name: all that the engine may touch, textures and samplers of
/// the first `texture_units` units, indexed state of the first `draw_buffers` draw buffers. OpenGL has no
/// question for these, so the host must see to them:
///  - conditional rendering must be off, or the engine's draws may be dropped;
///  - transform feedback must be inactive below OpenGL 4.0 (from 4.0 on it is paused and resumed);
///  - active queries stay active and count the engine's draws too;
///  - filters set by glDebugMessageControl are neither known nor changed.
class HostState {
  public:
    explicit HostState(const Functions& gl);

    /// Reads the state. Errors that the host left pending are drained first, so that they are not taken for
    /// ours, counted, and reported to `log` as fault "gl.host_error". Allocates nothing once warm.
    void save(Log& log);
    /// Sets the state back to what save() read.
    void restore() const;

    /// Errors of the host's found by all save() calls.
    [[nodiscard]] std::uint64_t host_errors() const { return host_errors_; }

    struct Entry {
        const HostStateRow* row;
        std::size_t offset;
    };
    /// The rows that this context has, in the order of restore().
    [[nodiscard]] std::span<const Entry> entries() const& { return entries_; }
    std::span<const Entry> entries() && = delete;
    [[nodiscard]] std::span<const GLint64> values(const Entry& entry) const {
        return std::span(values_).subspan(entry.offset, entry.row->slots);
    }

  private:
    const Functions* gl_;
    std::vector<Entry> entries_;
    std::vector<GLint64> values_;
    std::uint64_t host_errors_ = 0;
};

/// Saves on entry, restores on every way out.
class HostStateScope {
  public:
    HostStateScope(HostState& state, Log& log) : state_(&state) { state_->save(log); }
    ~HostStateScope() { state_->restore(); }
    HostStateScope(const HostStateScope&) = delete;
    HostStateScope& operator=(const HostStateScope&) = delete;

  private:
    HostState* state_;
};

}  // namespace viscera::gl
