#pragma once

namespace viscera {

/// Which context is current on this thread, as EGL, GLX or OSMesa tell it.
///
/// Mesa's libraries share one slot for the current context but each keeps its own belief of what is in it:
/// binding a context that EGL still believes current, after OSMesa took the slot, does nothing, and the calls
/// go to OSMesa. So whatever is current is released before another is bound. Libraries that are not loaded
/// are not touched.
class CurrentSlot {
  public:
    /// What is current now. Empty when nothing is.
    [[nodiscard]] static CurrentSlot capture();
    /// Leaves nothing current on this thread, whoever made it so.
    static void release();

    /// Makes the captured context current again after a release(). False when it was empty or the library
    /// refused.
    bool bind() const;
    [[nodiscard]] bool empty() const { return kind_ == Kind::none; }
    bool operator==(const CurrentSlot&) const = default;

  private:
    enum class Kind { none, egl, glx, osmesa };

    Kind kind_ = Kind::none;
    void* display_ = nullptr;
    void* context_ = nullptr;
    void* egl_draw_ = nullptr;
    void* egl_read_ = nullptr;
    unsigned long glx_draw_ = 0;
    unsigned long glx_read_ = 0;
    void* osmesa_buffer_ = nullptr;
    int osmesa_type_ = 0;
    int osmesa_width_ = 0;
    int osmesa_height_ = 0;
};

/// Puts back, at the end of its scope, the context that was current at its start.
class KeepCurrent {
  public:
    KeepCurrent() : before_(CurrentSlot::capture()) {}
    KeepCurrent(const KeepCurrent&) = delete;
    KeepCurrent& operator=(const KeepCurrent&) = delete;
    ~KeepCurrent() {
        if (!dismissed_) {
            CurrentSlot::release();
            before_.bind();
        }
    }
    /// What is current now may stay.
    void dismiss() { dismissed_ = true; }

  private:
    CurrentSlot before_;
    bool dismissed_ = false;
};

}  // namespace viscera
