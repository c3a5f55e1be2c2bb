#pragma once

#include <functional>
#include <memory>

#include "engine/context/context.h"

namespace viscera {

enum class MouseButton { left = 0, right = 1, middle = 2 };

/// Keys that have no character of their own; any other key is the character on it, upper-case: 'R', '1'.
/// Values are GLFW's.
namespace key {
inline constexpr int escape = 256;
inline constexpr int enter = 257;
inline constexpr int tab = 258;
inline constexpr int right = 262;
inline constexpr int left = 263;
inline constexpr int down = 264;
inline constexpr int up = 265;
inline constexpr int keypad_0 = 320;  ///< keypad_0 + n is the keypad's digit n
}  // namespace key

struct Modifiers {
    bool shift = false;
    bool control = false;
    bool alt = false;
};

/// What a window tells of its user, called from WindowContext::poll(). Positions are in pixels of the
/// framebuffer, origin at the lower left, as targets have it. Empty ones are skipped.
struct WindowEvents {
    std::function<void(double x, double y)> cursor;
    std::function<void(MouseButton button, bool pressed, Modifiers modifiers)> button;
    std::function<void(int key, bool pressed, Modifiers modifiers)> key;  ///< pressed again when it repeats
    std::function<void(double x, double y)> scroll;                       ///< in notches; y > 0 is away
    std::function<void(int width, int height)> resize;                    ///< [pixels]
};

struct PixelSize {
    int width = 0;
    int height = 0;
};

struct CursorPosition {
    double x = 0.0;
    double y = 0.0;
};

/// A context with a window. Use it on the process's main thread only. Buffer swaps wait for the display's
/// refresh.
class WindowContext : public Context {
  public:
    virtual void swap() = 0;
    /// Handles what the user did since the last call. Throws what the first of `events` threw.
    virtual void poll() = 0;
    [[nodiscard]] virtual bool should_close() const = 0;
    virtual void close() = 0;
    [[nodiscard]] virtual PixelSize framebuffer_size() const = 0;
    [[nodiscard]] virtual CursorPosition cursor() const = 0;
    virtual void set_title(const std::string& title) = 0;
    /// The GLFWwindow, for GUI libraries.
    [[nodiscard]] virtual void* native_window() const = 0;

    WindowEvents events;
};

/// Opens a window (hidden unless options.visible). Throws Error(context) that says why not: no display, no
/// GLFW, no OpenGL 3.3.
[[nodiscard]] std::unique_ptr<WindowContext> create_window(const ContextOptions& options = {});

}  // namespace viscera
