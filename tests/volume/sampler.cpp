#include "tests/volume/sampler.h"

#include <cstring>
#include <stdexcept>

#include "effects/volume/prefilter.h"
#include "engine/core/hash.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/runtime/embedded_shaders.h"

namespace viscera::test {
namespace {

constexpr int row = 256;  // places per row of the pictures

constexpr std::string_view fragment = R"(#version 330 core
#include "volume/sample.glsl"
uniform sampler2D u_places;
out vec4 o_sample;

void main() {
    vec3 place = texelFetch(u_places, ivec2(gl_FragCoord.xy), 0).xyz;
    o_sample = vec4(sample_gradient(place), sample_volume(place));
}
)";

/// A fetch of the texture unit, and one with weights of 8 bits in its place.
constexpr std::string_view own_sampler = "uniform sampler3D u_volume;";
constexpr std::string_view own_fetch = "textureLod(u_volume, within_texture(place), 0.0).CHANNELS";
constexpr std::string_view eight_bit_fetch = "eight_bit_texel(within_texture(place))";
constexpr std::string_view eight_bit_texel = R"(
float eight_bit_texel(vec3 place) {
    ivec3 last = textureSize(u_volume, 0) - 1;
    vec3 p = place * vec3(last + 1) - 0.5;
    ivec3 low = ivec3(floor(p));
    vec3 a = floor((p - floor(p)) * 256.0 + 0.5) / 256.0;
    float sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        ivec3 step = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        vec3 w = mix(1.0 - a, a, vec3(step));
        sum += w.x * w.y * w.z * texelFetch(u_volume, clamp(low + step, ivec3(0), last), 0).r;
    }
    return sum;
}
)";

std::string with_eight_bits(std::string text) {
    const auto change = [&](std::string_view from, const std::string& to) {
        const std::size_t at = text.find(from);
        if (at == std::string::npos) {
            throw std::logic_error("volume/storage.glsl has no '" + std::string(from) + "'");
        }
        text.replace(at, from.size(), to);
    };
    change(own_fetch, std::string(eight_bit_fetch));
    change(own_sampler, std::string(own_sampler) + std::string(eight_bit_texel));
    return text;
}

ShaderReader with_sampler(VolumeSampler::Weights weights) {
    return [engine = embedded_shader_reader(), weights](std::string_view name) {
        if (name == "sampler.frag") {
            return std::optional(std::string(fragment));
        }
        std::optional<std::string> text = engine(name);
        const bool coarse = weights == VolumeSampler::Weights::eight_bits && name == "volume/storage.glsl";
        return coarse ? std::optional(with_eight_bits(*text)) : text;
    };
}

gl::Program make_program(const gl::Functions& gl, VolumeSampler::Weights weights,
                         std::vector<std::string> defines, bool atlas) {
    if (atlas) {
        defines.emplace_back("STORAGE_ATLAS");
    }
    const ShaderReader reader = with_sampler(weights);
    return {gl, expand_shader("common/fullscreen.vert", defines, reader),
            expand_shader("sampler.frag", defines, reader), "sampler"};
}

}  // namespace

VolumeSampler::VolumeSampler(Weights weights)
    : weights_(weights),
      context_(create_context(Backend::osmesa, {.debug = true})),
      gl_(gl::Functions::load(context_->proc_address())),
      assets_(std::make_unique<Assets>(log_)),
      no_vertices_(std::in_place, *gl_) {}

std::vector<VolumeSampler::Sample> VolumeSampler::sample(const volume::Source& source,
                                                         const volume::ReconstructionParams& reconstruction,
                                                         volume::Storage storage,
                                                         std::span<const glm::vec3> places) {
    std::shared_ptr<const volume::Source> coefficients;
    if (reconstruction.uses_coefficients()) {
        coefficients = volume::load_coefficients(*assets_, source, 0);
    }
    volume::GpuVolume gpu(*gl_, coefficients ? *coefficients : source, 0, storage);
    return sample(gpu, source, reconstruction, places);
}

std::vector<VolumeSampler::Sample> VolumeSampler::sample(volume::GpuVolume& gpu, const volume::Source& source,
                                                         const volume::ReconstructionParams& reconstruction,
                                                         std::span<const glm::vec3> places) {
    const int height = static_cast<int>((places.size() + row - 1) / row);
    std::vector<glm::vec4> texels(static_cast<std::size_t>(row) * static_cast<std::size_t>(height),
                                  glm::vec4(0.5F));
    for (std::size_t i = 0; i < places.size(); ++i) {
        texels[i] = glm::vec4(places[i], 0.0F);
    }
    gl::Texture input = gl::Texture::make_2d(*gl_, row, height, PixelFormat::rgba32f, "places");
    input.upload(std::as_bytes(std::span(texels)));
    const gl::Texture output = gl::Texture::make_2d(*gl_, row, height, PixelFormat::rgba32f, "samples");
    const gl::Framebuffer framebuffer(*gl_, output, "samples");
    framebuffer.bind();
    gl::apply(*gl_, gl::overwrite_state, {0, 0, row, height});
    const gl::Program program = make_program(*gl_, weights_, reconstruction.defines(), gpu.is_atlas());
    program.use();
    gpu.set(program);
    const gl::Sampler filtered(*gl_, {.filter = reconstruction.texture_filter()});
    const gl::Sampler plain(*gl_, {.filter = gl::Filter::nearest});
    program.bind("u_volume", gpu.texture(), filtered);
    program.bind("u_places", input, plain);
    no_vertices_->bind();
    gl_->DrawArrays(GL_TRIANGLES, 0, 3);
    const Image image = gl::read_texture(*gl_, output);
    std::memcpy(texels.data(), image.data.data(), image.data.size());

    const Volume& volume = source.volume();
    const double scale = volume.slope * gpu.map().scale;
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < places.size(); ++i) {
        samples.push_back({scale * glm::dvec3(texels[i]),
                           volume.value_of(gpu.map().value_of(static_cast<double>(texels[i].w)))});
    }
    return samples;
}

volume::Source make_source(Volume volume) {
    volume::Source source;
    source.statistics = statistics(volume);
    source.key = Hash().bytes(volume.voxels).add(volume.grid.dims).add(volume.type).value();
    source.owned = std::make_shared<const Volume>(std::move(volume));
    return source;
}

}  // namespace viscera::test
