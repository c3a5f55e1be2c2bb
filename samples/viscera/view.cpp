#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <optional>

#include "engine/context/window.h"
#include "engine/core/error.h"
#include "engine/io/exr.h"
#include "engine/io/png.h"
#include "engine/runtime/renderer.h"
#include "samples/viscera/camera_control.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/interactive_rate.h"
#include "samples/viscera/session.h"
#include "samples/viscera/slice_hand.h"
#include "samples/viscera/title_progress.h"
#include "samples/viscera/window_hand.h"

namespace viscera::app {
namespace {

constexpr std::string_view help = R"(left drag           rotate
middle, Shift+left  pan
right drag, wheel   zoom
wheel, up, down     the next slice, where slices are shown (Shift+arrow: ten on)
L and left drag     window (sideways) and level (up, down) of volumes
keypad 1, 3, 7      front, left, head
space               stop and go on in time
left, right         one frame back, on
T                   time back to the scene's beginning
Tab                 next target
S, E                save the target as PNG, as EXR
R                   reset the camera, slices, window and level
F                   read shaders again (with --glsl)
H                   this help
Esc                 quit
)";

struct ViewArguments {
    SceneArguments scene;
    ComputeArgument compute;
    CacheArgument cache;
    std::filesystem::path folder = "out";
    std::filesystem::path glsl;
    double frame_time_ms = SamplingRateOptions{}.target_ms;
    bool full_quality = false;
    std::uint64_t frames = 0;  ///< ends after so many; 0: when the window is closed
};

/// A window onto a scene: the user's hands on the camera and on time.
class Viewer {
  public:
    Viewer(const ViewArguments& arguments, WindowContext& window, Renderer& renderer)
        : arguments_(arguments),
          window_(window),
          renderer_(renderer),
          camera_(renderer.scene().camera),
          levels_(renderer),
          slices_(renderer) {
        window_.events.button = [this](MouseButton button, bool pressed, Modifiers modifiers) {
            press(button, pressed, modifiers);
        };
        window_.events.cursor = [this](double x, double y) { drag(x, y); };
        window_.events.scroll = [this](double, double y) {
            if (slices_.shows(targets_[target_])) {
                slices_.scroll(targets_[target_], y);
            } else {
                zoom(camera_, std::pow(1.1, y));
            }
        };
        window_.events.key = [this](int key, bool pressed, Modifiers modifiers) {
            if (key == 'L') {
                holds_l_ = pressed;
            } else if (pressed) {
                type(key, modifiers.shift ? 10.0 : 1.0);
            }
        };
        const bool volumes = std::ranges::any_of(renderer.scene().passes, [](const ScenePass& pass) {
            return pass.effect.starts_with("volume.");
        });
        if (volumes && !arguments.full_quality) {
            rate_.emplace(arguments.frame_time_ms, window.proc_address());
        }
        targets_.push_back(renderer.scene().outputs.front());
    }

    void run() {
        Clock::time_point last = Clock::now();
        for (std::uint64_t drawn = 0;
             !window_.should_close() && (arguments_.frames == 0 || drawn < arguments_.frames); ++drawn) {
            window_.poll();
            const Clock::time_point now = Clock::now();
            time_s_ += running_ ? std::chrono::duration<double>(now - last).count() : 0.0;
            last = now;
            draw();
            window_.swap();
        }
    }

  private:
    using Clock = std::chrono::steady_clock;
    enum class Hand { none, rotate, pan, zoom, window };

    void draw() {
        const PixelSize size = window_.framebuffer_size();
        if (size.width < 1 || size.height < 1) {
            return;  // minimised
        }
        Frame frame = make_frame(size);
        if (rate_) {
            frame.quality = rate_->begin(frame, levels_.revision() + slices_.revision());
        }
        const FrameReport& report = renderer_.render(frame);
        if (rate_) {
            rate_->end(report);
        }
        shows_full_ = frame.quality.full();
        if (targets_.size() == 1) {
            list_targets();
        }
    }

    [[nodiscard]] Frame make_frame(PixelSize size) const {
        const int pictures = camera_.stereo ? 2 : 1;  // side by side
        Frame frame{.width = std::max(1, size.width / pictures), .height = size.height, .time_s = time_s_};
        frame.look(make_eyes(camera_, frame.aspect(), time_s_));
        frame.host_state = HostStatePolicy::host_resets;
        frame.present = {.enabled = true,
                         .output = targets_[target_],
                         .framebuffer = 0,
                         .viewport = {0, 0, size.width, size.height}};
        return frame;
    }

    /// Every target that lives can be looked at; what is looked at becomes an output.
    void list_targets() {
        for (const PlanContent& content : renderer_.plan().contents) {
            if (!content.writer || !content.texture) {
                continue;
            }
            // What each eye has is shown of both.
            const std::string base = content.target.substr(0, content.target.rfind('.'));
            const auto own = renderer_.names_of(base);
            const std::string& name =
                std::ranges::find(own, content.target) == own.end() ? content.target : base;
            if (std::ranges::find(targets_, name) == targets_.end()) {
                targets_.push_back(name);
            }
        }
    }

    void press(MouseButton button, bool pressed, Modifiers modifiers) {
        hand_ = !pressed                        ? Hand::none
                : button == MouseButton::right  ? Hand::zoom
                : button == MouseButton::middle ? Hand::pan
                : modifiers.shift               ? Hand::pan
                : holds_l_                      ? Hand::window
                                                : Hand::rotate;
        at_ = window_.cursor();
    }

    void drag(double x, double y) {
        const double height = std::max(1, window_.framebuffer_size().height);
        const double dx = (x - at_.x) / height;
        const double dy = (y - at_.y) / height;
        at_ = {x, y};
        switch (hand_) {
            case Hand::rotate:
                return rotate(camera_, dx, dy);
            case Hand::pan:
                return pan(camera_, dx, dy);
            case Hand::zoom:
                return zoom(camera_, std::exp(2.0 * dy));
            case Hand::window:
                return levels_.drag(dx, dy);
            case Hand::none:
                return;
        }
    }

    /// leap: slices that an arrow goes on.
    void type(int pressed, double leap) {
        const double step_s = 1.0 / renderer_.scene().frames_per_second;
        switch (pressed) {
            case key::escape:
                return window_.close();
            case key::tab:
                target_ = (target_ + 1) % targets_.size();
                renderer_.keep({targets_[target_]});
                return window_.set_title("viscera: " + targets_[target_]);
            case key::up:
                return slices_.scroll(targets_[target_], leap);
            case key::down:
                return slices_.scroll(targets_[target_], -leap);
            case key::left:
                time_s_ = std::max(0.0, time_s_ - step_s);
                return;
            case key::right:
                time_s_ += step_s;
                return;
            case ' ':
                running_ = !running_;
                return;
            case 'T':
                time_s_ = 0.0;
                return;
            case 'R':
                camera_ = renderer_.scene().camera;
                slices_.reset();
                return levels_.reset();
            case 'S':
                return save(".png");
            case 'E':
                return save(".exr");
            case 'F':
                if (!arguments_.glsl.empty()) {
                    renderer_.reload_shaders(arguments_.glsl);
                }
                return;
            case 'H':
                std::cerr << help;
                return;
            case key::keypad_0 + 1:
            case key::keypad_0 + 3:
            case key::keypad_0 + 7:
                return standard_view(camera_, pressed - key::keypad_0);
            default:
                return;
        }
    }

    void save(const std::string& extension) {
        if (!shows_full_) {
            renderer_.render(make_frame(window_.framebuffer_size()));
        }
        std::filesystem::create_directories(arguments_.folder);
        for (const std::string& name : renderer_.names_of(targets_[target_])) {
            const std::filesystem::path file =
                arguments_.folder / (name + "." + std::to_string(saved_) + extension);
            io::ExrPart part{.name = name, .image = renderer_.read(name)};
            if (extension == ".exr") {
                io::write_exr(file, std::span(&part, 1));
            } else {
                io::write_png(file, part.image, {.alpha = false});
            }
            std::cout << file.string() << '\n';
        }
        ++saved_;
    }

    const ViewArguments& arguments_;
    WindowContext& window_;
    Renderer& renderer_;
    CameraParams camera_;
    WindowHand levels_;
    SliceHand slices_;
    std::optional<InteractiveRate> rate_;
    bool shows_full_ = true;
    bool holds_l_ = false;
    double time_s_ = 0.0;
    bool running_ = true;
    Hand hand_ = Hand::none;
    CursorPosition at_;
    std::vector<std::string> targets_;
    std::size_t target_ = 0;
    int saved_ = 0;
};

int view(const ViewArguments& arguments) {
    Scene scene = arguments.scene.load();
    const Registry registry = make_registry();
    const std::unique_ptr<WindowContext> window =
        create_window({.width = scene.width * (scene.camera.stereo ? 2 : 1),
                       .height = scene.height,
                       .title = "viscera: " + scene.name});
    const LogCallback log = stderr_log();
    name_renderer(window->info(), log);
    TitleProgress progress(*window, "viscera: " + scene.name);
    Renderer renderer(window->proc_address(), registry,
                      {.log = log,
                       .compute = arguments.compute.value(),
                       .progress = std::ref(progress),
                       .cache_folder = arguments.cache.folder()});
    renderer.set_scene(std::move(scene));
    try {
        Viewer(arguments, *window, renderer).run();
    } catch (const Error&) {
        if (!progress.cancelled()) {
            throw;
        }
    }
    return 0;
}

}  // namespace

void add_view(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand("view", "Shows a scene in a window");
    const auto arguments = std::make_shared<ViewArguments>();
    arguments->scene.add_to(*command);
    arguments->compute.add_to(*command);
    arguments->cache.add_to(*command);
    command->add_option("-o,--output", arguments->folder, "folder for pictures saved with S and E");
    command->add_option("--glsl", arguments->glsl, "folder from which F reads shaders again")
        ->check(CLI::ExistingDirectory);
    command->add_option("--frame-time", arguments->frame_time_ms,
                        "[ms] that a frame with volumes may take while something moves; step and resolution "
                        "follow it");
    command->add_flag("--full-quality", arguments->full_quality, "draws every frame in full");
    command->add_option("--frames", arguments->frames, "ends after so many frames");
    command->footer(std::string(help));
    command->callback([arguments, &exit_code] { exit_code = view(*arguments); });
}

}  // namespace viscera::app
