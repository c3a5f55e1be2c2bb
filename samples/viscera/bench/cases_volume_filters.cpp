#include <cmath>
#include <ctime>
#include <numbers>
#include <thread>

#include "effects/volume/gpu_volume.h"
#include "effects/volume/prefilter.h"
#include "effects/volume/reconstruction.h"
#include "engine/gl/buffer.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/runtime/assets.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/shader_pass.h"

namespace viscera::app {
namespace {

using volume::ReconstructionFilter;
using volume::ReconstructionParams;

/// Samples per axis of the signals.
constexpr std::array signal_sizes{41, 81, 161};

double spacing_of(int voxels) {
    return 2.0 / (voxels - 1);
}

/// Place of texture coordinates in the signal's own frame.
glm::dvec3 signal_place(const glm::dvec3& texture, int voxels) {
    return spacing_of(voxels) * (static_cast<double>(voxels) * texture - 0.5) - 1.0;
}

/// The test signal of Marschner and Lobb, "An evaluation of reconstruction filters for volume rendering"
/// (1994), on [-1, 1]^3.
double marschner_lobb(const glm::dvec3& p) {
    constexpr double pi = std::numbers::pi;
    const double wave = std::cos(12.0 * pi * std::cos(0.5 * pi * std::hypot(p.x, p.y)));
    return (1.0 - std::sin(0.5 * pi * p.z) + 0.25 * (1.0 + wave)) / 2.5;
}

/// Sum of the signal's three derivatives.
double marschner_lobb_slope(const glm::dvec3& p) {
    constexpr double pi = std::numbers::pi;
    const double r = std::hypot(p.x, p.y);
    const double radial =
        0.25 * std::sin(12.0 * pi * std::cos(0.5 * pi * r)) * 12.0 * pi * 0.5 * pi * std::sin(0.5 * pi * r);
    const double outwards = r > 0.0 ? (p.x + p.y) / r : 0.0;
    return (radial * outwards - 0.5 * pi * std::cos(0.5 * pi * p.z)) / 2.5;
}

volume::Source make_signal(int voxels) {
    const double spacing = spacing_of(voxels);
    std::vector<float> values;
    for (int z = 0; z < voxels; ++z) {
        for (int y = 0; y < voxels; ++y) {
            for (int x = 0; x < voxels; ++x) {
                values.push_back(static_cast<float>(marschner_lobb(spacing * glm::dvec3(x, y, z) - 1.0)));
            }
        }
    }
    Volume volume{.grid = {.dims = glm::ivec3(voxels)}, .type = ScalarType::f32, .source = "signal"};
    const auto bytes = std::as_bytes(std::span(values));
    volume.voxels.assign(bytes.begin(), bytes.end());
    volume::Source source;
    source.statistics = statistics(volume);
    source.key = static_cast<std::uint64_t>(voxels);
    source.owned = std::make_shared<const Volume>(std::move(volume));
    return source;
}

struct FilterCase {
    const char* name;
    ReconstructionFilter filter;
    bool prefilter;
};
constexpr std::array<FilterCase, 9> filter_cases{
    {{"nearest", ReconstructionFilter::nearest, false},
     {"linear", ReconstructionFilter::linear, false},
     {"linear_fp32", ReconstructionFilter::linear_fp32, false},
     {"bspline without prefilter", ReconstructionFilter::bspline, false},
     {"bspline_fp32 without prefilter", ReconstructionFilter::bspline_fp32, false},
     {"bspline", ReconstructionFilter::bspline, true},
     {"bspline_fp32", ReconstructionFilter::bspline_fp32, true},
     {"catmull_rom", ReconstructionFilter::catmull_rom, false},
     {"catmull_rom_fp32", ReconstructionFilter::catmull_rom_fp32, false}}};

double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Draws one program over a target again and again.
class Drawing {
  public:
    Drawing(Lab& lab, const gl::Program& program)
        : lab_(lab),
          program_(program),
          target_(gl::Texture::make_2d(lab.gl(), lab.options().width, lab.options().height,
                                       PixelFormat::rgba32f, "samples")),
          framebuffer_(lab.gl(), target_, "samples"),
          no_vertices_(lab.gl()) {}

    [[nodiscard]] Samples measure(const volume::GpuVolume& gpu, const ReconstructionParams& params) {
        const gl::Functions& gl = lab_.gl();
        const gl::Sampler sampler(gl, {.filter = params.texture_filter()});
        framebuffer_.bind();
        gl::apply(gl, gl::overwrite_state, {0, 0, target_.width(), target_.height()});
        program_.use();
        program_.set("u_pixels", glm::vec2(target_.width(), target_.height()));
        gpu.set(program_);
        program_.bind("u_volume", gpu.texture(), sampler);
        no_vertices_.bind();
        Samples samples;
        for (int i = -2; i < lab_.options().repeats; ++i) {  // the first ones compile
            gl::GpuTimer timer(gl);
            gl.Finish();
            const gl::CpuTimer wall;
            const double work = processor_ms();
            timer.begin();
            gl.DrawArrays(GL_TRIANGLES, 0, 3);
            timer.end();
            gl.Finish();
            const Sample sample{wall.milliseconds(), processor_ms() - work};
            if (i >= 0) {
                samples.push_back(lab_.hardware() ? Sample{timer.latest_ms().value_or(sample.time_ms), 0.0}
                                                  : sample);
            }
        }
        return samples;
    }

    /// Root mean square difference to the signal, or to the sum of its derivatives as a share of their own
    /// root mean square.
    [[nodiscard]] double error(int voxels, bool gradient) const {
        const Image image = gl::read_texture(lab_.gl(), target_);
        double squares = 0.0;
        double whole = 0.0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const glm::dvec3 p =
                    signal_place({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)}, voxels);
                const double due =
                    gradient ? marschner_lobb_slope(p) * spacing_of(voxels) * voxels : marschner_lobb(p);
                const double off = static_cast<double>(image.at(x, y, 3)) - due;
                squares += off * off;
                whole += gradient ? due * due : 1.0;
            }
        }
        return std::sqrt(squares / whole);
    }

  private:
    Lab& lab_;
    const gl::Program& program_;
    gl::Texture target_;
    gl::Framebuffer framebuffer_;
    gl::VertexArray no_vertices_;
};

gl::Program make_program(Lab& lab, const ReconstructionParams& params, bool atlas, bool gradient) {
    std::vector<std::string> defines = params.defines();
    if (atlas) {
        defines.emplace_back("STORAGE_ATLAS");
    }
    if (gradient) {
        defines.emplace_back("GRADIENT");
    }
    const ShaderReader reader = bench_shaders();
    return {lab.gl(), expand_shader("common/fullscreen.vert", defines, reader),
            expand_shader("bench/filter.frag", defines, reader), "filter"};
}

}  // namespace

namespace {

/// One filter on one signal.
struct FilterShot {
    FilterCase filter;
    int voxels;
    volume::Storage storage;
    bool gradient;

    [[nodiscard]] bool is_base() const {
        return filter.filter == ReconstructionFilter::linear && !gradient &&
               storage == volume::Storage::texture_3d;
    }
    [[nodiscard]] std::string name() const {
        return std::string(filter.name) + (storage == volume::Storage::atlas ? ", atlas" : "") +
               (gradient ? ", gradient" : "") + ", " + std::to_string(voxels);
    }
};

/// `linear`: the cost of one fetch of the texture unit, which is set by its own row.
void run_shot(Lab& lab, Assets& assets, const volume::Source& signal, const FilterShot& shot,
              Samples& linear) {
    const ReconstructionParams params{shot.filter.filter, shot.filter.prefilter};
    std::shared_ptr<const volume::Source> coefficients;
    if (params.uses_coefficients()) {
        coefficients = volume::load_coefficients(assets, signal, 0);
    }
    const volume::GpuVolume gpu(lab.gl(), coefficients ? *coefficients : signal, 0, shot.storage);
    const gl::Program program = make_program(lab, params, gpu.is_atlas(), shot.gradient);
    Drawing drawing(lab, program);
    const Samples samples = drawing.measure(gpu, params);
    if (shot.is_base()) {
        linear = samples;
    }
    const double drawn = static_cast<double>(lab.options().width) * lab.options().height;
    lab.add({.group = "filters",
             .name = shot.name(),
             .samples = samples,
             .rms = drawing.error(shot.voxels, shot.gradient),
             .error_of = shot.gradient ? "its derivatives, relative" : "Marschner-Lobb",
             .value = 1e6 * (lab.hardware() ? times(samples) : works(samples)).median / drawn,
             .unit = shot.gradient ? "ns per gradient" : "ns per sample",
             .ceiling = linear.empty() ? "" : "linear",
             .base = linear});
}

}  // namespace

void run_filters(Lab& lab) {
    Log log;
    Assets assets(log);
    for (const int voxels : signal_sizes) {
        const volume::Source signal = make_signal(voxels);
        Samples linear;
        for (const volume::Storage storage : {volume::Storage::texture_3d, volume::Storage::atlas}) {
            for (const FilterCase& filter : filter_cases) {
                for (const bool gradient : {false, true}) {
                    const bool atlas = storage == volume::Storage::atlas;
                    // Storage is a matter of cost, of which one size tells enough.
                    if (!atlas || (!gradient && !filter.prefilter && voxels == 81)) {
                        run_shot(lab, assets, signal, {filter, voxels, storage, gradient}, linear);
                    }
                }
            }
        }
    }
}

}  // namespace viscera::app
