#pragma once

#include <GL/glcorearb.h>

#include "engine/core/image.h"

namespace host {

/// How the host finds OpenGL's functions, and what it hands to viscera.
using ProcAddress = void* (*)(const char* name);

/// What a host draws without viscera: an orange triangle on dark blue. It binds its program and vertex array
/// once and relies on finding them bound in every frame.
class Triangle {
  public:
    explicit Triangle(ProcAddress proc);
    Triangle(const Triangle&) = delete;
    Triangle& operator=(const Triangle&) = delete;
    ~Triangle();

    /// Clears a framebuffer and draws the triangle into its left half.
    void draw(GLuint framebuffer, int width, int height) const;
    /// What a framebuffer shows now.
    [[nodiscard]] viscera::Image read(GLuint framebuffer, int width, int height) const;

  private:
    ProcAddress proc_;
    GLuint program_ = 0;
    GLuint vertices_ = 0;
};

/// A framebuffer of the host's own, for hosts without a window.
class Offscreen {
  public:
    Offscreen(ProcAddress proc, int width, int height);
    Offscreen(const Offscreen&) = delete;
    Offscreen& operator=(const Offscreen&) = delete;
    ~Offscreen();
    [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }

  private:
    ProcAddress proc_;
    GLuint texture_ = 0;
    GLuint framebuffer_ = 0;
};

}  // namespace host
