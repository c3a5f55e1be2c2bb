#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "engine/gl/functions.h"

namespace viscera::test {

/// Watches what is done through the functions that a loader gives out: which objects are made and not yet
/// deleted, and how often framebuffer 0 is bound. OpenGL's functions take no user data, so a recorder belongs
/// to the thread that made it; one at a time.
class Recorder {
  public:
    explicit Recorder(ProcAddress real);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    ~Recorder();

    /// What to hand out in the loader's place.
    [[nodiscard]] ProcAddress proc() const;
    /// Number of objects alive, by kind ("Textures"); kinds without any are left out.
    [[nodiscard]] std::map<std::string, std::size_t> alive() const;
    /// Number of objects made so far.
    [[nodiscard]] std::size_t made() const { return made_; }
    /// Forgets a texture that the host has taken over.
    void forget_texture(GLuint texture);
    /// From now on the name `seen` stands for the texture `real`: as when a driver gives the name of a
    /// deleted texture to a new one, which Mesa does not.
    void reuse_name(GLuint seen, GLuint real) { renamed_ = {seen, real}; }
    /// From now on no fence is reached for one who does not wait for it; or again as the driver says.
    void hold_fences(bool held = true) { fences_held_ = held; }
    /// Number of calls so far that wait for the GPU: glFinish, waits for fences, and reading back into
    /// memory.
    [[nodiscard]] std::size_t waits() const { return waits_; }
    /// The next mapping loses what it showed.
    void lose_mapping() { mapping_lost_ = true; }
    [[nodiscard]] int default_framebuffer_binds() const { return default_framebuffer_binds_; }

  private:
    struct Wrapped;
    friend struct Wrapped;
    static constexpr std::size_t kinds = 7;

    ProcAddress real_;
    std::array<std::set<GLuint>, kinds> alive_;
    std::set<GLuint> shaders_;
    std::set<GLuint> programs_;
    std::set<GLsync> syncs_;
    std::size_t made_ = 0;
    int default_framebuffer_binds_ = 0;
    bool fences_held_ = false;
    std::size_t waits_ = 0;
    bool mapping_lost_ = false;
    std::pair<GLuint, GLuint> renamed_{0, 0};
};

}  // namespace viscera::test
