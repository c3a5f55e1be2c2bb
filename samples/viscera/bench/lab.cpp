#include "samples/viscera/bench/lab.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>

#include "effects/register_all.h"
#include "engine/core/error.h"
#include "samples/viscera/bench/shader_pass.h"

namespace viscera::app {
namespace {

// A GPU needs some frames to leave its idle clocks.
constexpr int warm_frames_hardware = 30;
constexpr int warm_frames_software = 3;

Sample difference(const Sample& end, const Sample& start) {
    return {end.time_ms - start.time_ms, end.work_ms - start.work_ms};
}

}  // namespace

Lab::Lab(Context& context, Options options)
    : context_(context),
      options_(std::move(options)),
      gl_(gl::Functions::load(context.proc_address())),
      capabilities_(gl::Capabilities::query(*gl_)) {
    register_all(registry_);
    register_bench_effects(registry_);
}

nlohmann::json Lab::scene(std::string_view name) const {
    const std::filesystem::path file = options_.assets / "scenes" / name;
    std::ifstream stream(file);
    if (!stream) {
        throw Error(ErrorCode::file, file.string(), "cannot be opened; --assets names the folder");
    }
    nlohmann::json scene = nlohmann::json::parse(stream);
    scene["resolution"] = {options_.width, options_.height};
    return scene;
}

nlohmann::json Lab::empty_scene() const {
    nlohmann::json scene = default_scene();
    scene["passes"] = nlohmann::json::array();
    scene["targets"] = nlohmann::json::object();
    scene["outputs"] = nlohmann::json::array();
    return scene;
}

ShaderReader Lab::shaders() const {
    if (options_.glsl.empty()) {
        return bench_shaders();
    }
    return [own = shader_reader_from_folder(options_.glsl), others = bench_shaders()](std::string_view name) {
        std::optional<std::string> text = own(name);
        return text ? text : others(name);
    };
}

void Lab::add(Row row) {
    rows_.push_back(std::move(row));
}

Stage::Stage(Lab& lab, const nlohmann::json& scene, Options options)
    : Stage(lab, parse_scene(scene.dump(), lab.options().assets / "scenes" / "bench.json"),
            std::move(options)) {}

Stage::Stage(Lab& lab, Scene scene, Options options) : lab_(lab), options_(std::move(options)) {
    RendererOptions made{.log = lab.options().log,
                         .shaders = options_.shaders ? options_.shaders : lab.shaders(),
                         .timers = false,
                         .compute = options_.compute.value_or(lab.options().compute)};
    if (options_.by_pass) {
        made.observer = [this](std::string_view pass, bool begins) { observe(pass, begins); };
    }
    renderer_ = std::make_unique<Renderer>(lab.proc(), lab.registry(), std::move(made));
    renderer_->set_scene(std::move(scene));
    whole_timer_ = std::make_unique<gl::GpuTimer>(lab.gl());
}

Sample Stage::now() const {
    using Milliseconds = std::chrono::duration<double, std::milli>;
    if (options_.calling_thread) {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return {1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec), 0.0};
    }
    const Milliseconds wall = std::chrono::steady_clock::now().time_since_epoch();
    return {wall.count(), 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC};
}

void Stage::wait() const {
    if (!options_.calling_thread) {
        lab_.gl().Finish();
    }
}

void Stage::observe(std::string_view pass, bool begins) {
    if (!measured_) {
        return;
    }
    if (gpu_clock()) {
        auto found = timers_.find(pass);
        if (found == timers_.end()) {
            found = timers_.emplace(std::string(pass), std::make_unique<gl::GpuTimer>(lab_.gl())).first;
        }
        begins ? found->second->begin() : found->second->end();
    } else {
        wait();
        if (begins) {
            start_ = now();
        } else {
            passes_[std::string(pass)].push_back(difference(now(), start_));
        }
    }
    if (begins) {
        drawn_.emplace_back(pass);
    }
}

void Stage::frame(const Edit& edit, bool measured) {
    Frame frame = renderer_->still(options_.time_s + options_.step_s * static_cast<double>(index_));
    frame.index = index_++;
    frame.host_state = options_.host_state;
    if (edit) {
        edit(frame);
    }
    measured_ = measured;
    drawn_.clear();
    const Sample start = now();
    if (gpu_clock()) {
        whole_timer_->begin();
    }
    report_ = renderer_->render(frame);
    if (gpu_clock()) {
        whole_timer_->end();
    }
    wait();
    const Sample taken = difference(now(), start);
    lab_.gl().Finish();
    measured_ = false;
    if (!measured) {
        (void)whole_timer_->latest_ms();
        return;
    }
    whole_.push_back(gpu_clock() ? Sample{whole_timer_->latest_ms().value_or(0.0), 0.0} : taken);
    if (gpu_clock()) {
        for (const std::string& pass : drawn_) {
            passes_[pass].push_back({timers_.at(pass)->latest_ms().value_or(0.0), 0.0});
        }
    }
}

void Stage::run(const Edit& edit) {
    const int warm = options_.warm.value_or(lab_.hardware() ? warm_frames_hardware : warm_frames_software);
    for (int i = 0; i < warm; ++i) {
        frame(edit, false);
    }
    const int repeats = options_.repeats > 0 ? options_.repeats : lab_.options().repeats;
    for (int i = 0; i < repeats; ++i) {
        frame(edit, true);
    }
}

Image Stage::shot(std::string_view target, double time_s) {
    Frame frame = renderer_->still(time_s);
    report_ = renderer_->render(frame);
    return renderer_->read(target);
}

double largest_difference(const Image& a, const Image& b) {
    const std::vector<float> first = to_floats(a);
    const std::vector<float> second = to_floats(b);
    if (a.width != b.width || a.height != b.height || first.size() != second.size()) {
        return std::numeric_limits<double>::infinity();
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double difference = std::abs(static_cast<double>(first[i]) - static_cast<double>(second[i]));
        if (!(difference <= largest)) {
            largest = std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
        }
    }
    return largest;
}

}  // namespace viscera::app
