#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>
#include <exception>
#include <utility>

#include "engine/context/backends.h"
#include "engine/context/context_info.h"
#include "engine/context/current_slot.h"
#include "engine/context/shared_library.h"
#include "engine/context/window.h"
#include "engine/core/error.h"

namespace viscera {

namespace {

constexpr auto glfw = "glfw";
constexpr auto library_name = "libglfw.so.3";

struct GlfwApi {
    decltype(&glfwInit) init = nullptr;
    decltype(&glfwGetError) get_error = nullptr;
    decltype(&glfwDefaultWindowHints) default_window_hints = nullptr;
    decltype(&glfwWindowHint) window_hint = nullptr;
    decltype(&glfwCreateWindow) create_window = nullptr;
    decltype(&glfwDestroyWindow) destroy_window = nullptr;
    decltype(&glfwMakeContextCurrent) make_context_current = nullptr;
    decltype(&glfwGetCurrentContext) get_current_context = nullptr;
    decltype(&glfwGetProcAddress) get_proc_address = nullptr;
    decltype(&glfwSwapInterval) swap_interval = nullptr;
    decltype(&glfwSwapBuffers) swap_buffers = nullptr;
    decltype(&glfwPollEvents) poll_events = nullptr;
    decltype(&glfwWindowShouldClose) window_should_close = nullptr;
    decltype(&glfwSetWindowShouldClose) set_window_should_close = nullptr;
    decltype(&glfwSetWindowTitle) set_window_title = nullptr;
    decltype(&glfwGetFramebufferSize) get_framebuffer_size = nullptr;
    decltype(&glfwGetWindowSize) get_window_size = nullptr;
    decltype(&glfwGetCursorPos) get_cursor_pos = nullptr;
    decltype(&glfwSetWindowUserPointer) set_window_user_pointer = nullptr;
    decltype(&glfwSetCursorPosCallback) set_cursor_pos_callback = nullptr;
    decltype(&glfwSetMouseButtonCallback) set_mouse_button_callback = nullptr;
    decltype(&glfwSetKeyCallback) set_key_callback = nullptr;
    decltype(&glfwSetScrollCallback) set_scroll_callback = nullptr;
    decltype(&glfwSetFramebufferSizeCallback) set_framebuffer_size_callback = nullptr;

    static GlfwApi load();
    [[nodiscard]] std::string last_error() const {
        const char* text = nullptr;
        get_error(&text);
        return text != nullptr ? text : "no reason given";
    }
};

GlfwApi GlfwApi::load() {
    const auto library = SharedLibrary::open(glfw, {library_name}, "install the Debian package libglfw3");
    GlfwApi api;
    library.require(glfw, "glfwInit", api.init);
    library.require(glfw, "glfwGetError", api.get_error);
    library.require(glfw, "glfwDefaultWindowHints", api.default_window_hints);
    library.require(glfw, "glfwWindowHint", api.window_hint);
    library.require(glfw, "glfwCreateWindow", api.create_window);
    library.require(glfw, "glfwDestroyWindow", api.destroy_window);
    library.require(glfw, "glfwMakeContextCurrent", api.make_context_current);
    library.require(glfw, "glfwGetCurrentContext", api.get_current_context);
    library.require(glfw, "glfwGetProcAddress", api.get_proc_address);
    library.require(glfw, "glfwSwapInterval", api.swap_interval);
    library.require(glfw, "glfwSwapBuffers", api.swap_buffers);
    library.require(glfw, "glfwPollEvents", api.poll_events);
    library.require(glfw, "glfwWindowShouldClose", api.window_should_close);
    library.require(glfw, "glfwSetWindowShouldClose", api.set_window_should_close);
    library.require(glfw, "glfwSetWindowTitle", api.set_window_title);
    library.require(glfw, "glfwGetFramebufferSize", api.get_framebuffer_size);
    library.require(glfw, "glfwGetWindowSize", api.get_window_size);
    library.require(glfw, "glfwGetCursorPos", api.get_cursor_pos);
    library.require(glfw, "glfwSetWindowUserPointer", api.set_window_user_pointer);
    library.require(glfw, "glfwSetCursorPosCallback", api.set_cursor_pos_callback);
    library.require(glfw, "glfwSetMouseButtonCallback", api.set_mouse_button_callback);
    library.require(glfw, "glfwSetKeyCallback", api.set_key_callback);
    library.require(glfw, "glfwSetScrollCallback", api.set_scroll_callback);
    library.require(glfw, "glfwSetFramebufferSizeCallback", api.set_framebuffer_size_callback);
    return api;
}

Modifiers modifiers_of(int bits) {
    return {(bits & GLFW_MOD_SHIFT) != 0, (bits & GLFW_MOD_CONTROL) != 0, (bits & GLFW_MOD_ALT) != 0};
}

/// GLFW stays initialised when the window goes: the host may use it too.
class GlfwWindow final : public WindowContext {
  public:
    GlfwWindow(const GlfwApi& api, const ContextOptions& options) : api_(api) {
        CurrentSlot::release();  // GLX refuses to bind while another library's context is current
        api_.default_window_hints();
        api_.window_hint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        api_.window_hint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        api_.window_hint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
        api_.window_hint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
        for (const std::array<int, 2>& version : {options.version, {3, 3}}) {
            api_.window_hint(GLFW_CONTEXT_VERSION_MAJOR, version[0]);
            api_.window_hint(GLFW_CONTEXT_VERSION_MINOR, version[1]);
            window_ =
                api_.create_window(options.width, options.height, options.title.c_str(), nullptr, nullptr);
            if (window_ != nullptr) {
                break;
            }
        }
        if (window_ == nullptr) {
            throw Error(ErrorCode::context, glfw,
                        "no window with OpenGL 3.3 core: " + api_.last_error() +
                            "; its driver comes with the Debian packages libgl1 and libgl1-mesa-dri");
        }
        try {
            make_current();
            info_ = read_context_info(Backend::glfw, proc_address());
        } catch (...) {
            destroy();
            throw;
        }
        api_.swap_interval(1);
        listen();
    }
    ~GlfwWindow() override { destroy(); }

    void make_current() override {
        CurrentSlot::release();
        api_.make_context_current(window_);
        if (api_.get_current_context() != window_) {
            throw Error(ErrorCode::context, glfw, "cannot be made current: " + api_.last_error());
        }
        slot_ = CurrentSlot::capture();
    }
    void release() override {
        if (CurrentSlot::capture() == slot_) {
            api_.make_context_current(nullptr);
        }
    }
    [[nodiscard]] ProcAddress proc_address() const override {
        return reinterpret_cast<ProcAddress>(api_.get_proc_address);
    }

    void swap() override { api_.swap_buffers(window_); }
    void poll() override {
        api_.poll_events();
        if (failure_) {
            std::rethrow_exception(std::exchange(failure_, nullptr));
        }
    }
    [[nodiscard]] bool should_close() const override { return api_.window_should_close(window_) != 0; }
    void close() override { api_.set_window_should_close(window_, GLFW_TRUE); }
    [[nodiscard]] PixelSize framebuffer_size() const override {
        PixelSize size;
        api_.get_framebuffer_size(window_, &size.width, &size.height);
        return size;
    }
    [[nodiscard]] CursorPosition cursor() const override {
        double x = 0.0;
        double y = 0.0;
        api_.get_cursor_pos(window_, &x, &y);
        return to_pixels(x, y);
    }
    void set_title(const std::string& title) override { api_.set_window_title(window_, title.c_str()); }
    [[nodiscard]] void* native_window() const override { return window_; }

  private:
    void listen();
    /// Calls what listens to a window. No exception may pass through GLFW, which is C: poll() throws it.
    template <class Tell>
    static void tell(GLFWwindow* window, Tell&& tell);

    /// GLFW releases a window that it still believes current before it destroys it, which GLX takes for an
    /// error, and ends the process, while another library's context is current. So that one steps aside.
    void destroy() noexcept {
        const CurrentSlot current = CurrentSlot::capture();
        CurrentSlot::release();
        api_.destroy_window(window_);
        if (current != slot_) {
            current.bind();
        }
    }

    /// From GLFW's screen units, origin at the upper left.
    [[nodiscard]] CursorPosition to_pixels(double x, double y) const {
        int width = 0;
        int height = 0;
        api_.get_window_size(window_, &width, &height);
        const PixelSize pixels = framebuffer_size();
        if (width <= 0 || height <= 0) {
            return {};
        }
        return {x * pixels.width / width, pixels.height - y * pixels.height / height};
    }

    GlfwApi api_;
    GLFWwindow* window_ = nullptr;
    CurrentSlot slot_;            ///< what is current when this window is
    std::exception_ptr failure_;  ///< the first thing that a listener threw since poll()
};

template <class Tell>
void GlfwWindow::tell(GLFWwindow* window, Tell&& tell) {
    // The callbacks hold no state, so they find the reader of the window's user pointer in the loaded
    // library.
    const auto read = SharedLibrary::find_loaded({library_name})
                          ->find<decltype(&glfwGetWindowUserPointer)>("glfwGetWindowUserPointer");
    GlfwWindow& self = *static_cast<GlfwWindow*>(read(window));
    try {
        tell(self);
    } catch (...) {
        self.failure_ = self.failure_ ? self.failure_ : std::current_exception();
    }
}

void GlfwWindow::listen() {
    api_.set_window_user_pointer(window_, this);
    api_.set_cursor_pos_callback(window_, [](GLFWwindow* window, double x, double y) {
        tell(window, [&](const GlfwWindow& self) {
            if (self.events.cursor) {
                const CursorPosition at = self.to_pixels(x, y);
                self.events.cursor(at.x, at.y);
            }
        });
    });
    api_.set_mouse_button_callback(window_, [](GLFWwindow* window, int button, int action, int mods) {
        tell(window, [&](const GlfwWindow& self) {
            if (self.events.button && button <= GLFW_MOUSE_BUTTON_MIDDLE) {
                self.events.button(static_cast<MouseButton>(button), action == GLFW_PRESS,
                                   modifiers_of(mods));
            }
        });
    });
    api_.set_key_callback(window_, [](GLFWwindow* window, int key, int, int action, int mods) {
        tell(window, [&](const GlfwWindow& self) {
            if (self.events.key && key != GLFW_KEY_UNKNOWN) {
                self.events.key(key, action != GLFW_RELEASE, modifiers_of(mods));
            }
        });
    });
    api_.set_scroll_callback(window_, [](GLFWwindow* window, double x, double y) {
        tell(window, [&](const GlfwWindow& self) {
            if (self.events.scroll) {
                self.events.scroll(x, y);
            }
        });
    });
    api_.set_framebuffer_size_callback(window_, [](GLFWwindow* window, int width, int height) {
        tell(window, [&](const GlfwWindow& self) {
            if (self.events.resize) {
                self.events.resize(width, height);
            }
        });
    });
}

bool is_set(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

}  // namespace

std::unique_ptr<WindowContext> create_window(const ContextOptions& options) {
    // Asked before GLFW is: glfwInit without a display fails for good reason but tells little.
    if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) {
        throw Error(ErrorCode::context, glfw,
                    "no display: neither DISPLAY nor WAYLAND_DISPLAY is set; use egl or osmesa, or run under "
                    "xvfb-run (Debian packages xvfb and xauth)");
    }
    const GlfwApi api = GlfwApi::load();
    if (api.init() != GLFW_TRUE) {
        throw Error(ErrorCode::context, glfw, "the display cannot be opened: " + api.last_error());
    }
    KeepCurrent keep;  // what was current stays so when this fails
    auto window = std::make_unique<GlfwWindow>(api, options);
    check_hardware(window->info(), options);
    keep.dismiss();
    return window;
}

}  // namespace viscera
