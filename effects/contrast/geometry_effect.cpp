#include "effects/contrast/geometry_effect.h"

#include <algorithm>
#include <cmath>

#include "effects/contrast/density.h"
#include "effects/contrast/gpu_vessel.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/region.h"

namespace viscera::contrast {
GeometryEffect::GeometryEffect(Outputs outputs) : outputs_(outputs) {
    list_variants();
}

void GeometryEffect::list_variants() {
    using enum Scalar;
    const bool alone = outputs_.main && !outputs_.cloud && !outputs_.distance;
    for (const Scalar scalar : {none, density, arrival, arrival_table}) {
        for (int bits = 0; bits < 32; ++bits) {
            const auto bit = [bits](int i) { return ((bits >> i) & 1) != 0; };
            const Variant variant{scalar, bit(0), bit(1), bit(2), bit(3), bit(4)};
            const bool draws = scalar != none || variant.cloud || variant.distance;
            const bool made_here = (scalar == none || outputs_.main) && (!variant.cloud || outputs_.cloud) &&
                                   (!variant.distance || outputs_.distance);
            const bool weighted = scalar == arrival || scalar == arrival_table;
            const bool alone_only = variant.depth || variant.thickness;
            if (!draws || !made_here || (alone_only && !alone) ||
                ((variant.calibre || variant.thickness) && !weighted) ||
                (variant.thickness && (variant.calibre || variant.depth))) {
                continue;
            }
            int location = 0;
            ProgramDesc program{"contrast/geometry.vert", "contrast/geometry.frag", {}};
            const auto define = [&](const char* name) { program.defines.emplace_back(name); };
            const auto output = [&](bool made, bool in_variant, const char* name) {
                if (in_variant) {
                    program.defines.push_back(std::string(name) + " " + std::to_string(location));
                }
                location += made ? 1 : 0;
            };
            output(outputs_.main, scalar != none, "MAIN");
            output(outputs_.cloud, variant.cloud, "CLOUD");
            output(outputs_.distance, variant.distance, "DISTANCE");
            if (variant.cloud || variant.distance) {
                define("INJECTION");
            }
            if (variant.calibre) {
                define("CALIBRE");
            }
            if (weighted) {
                define("ARRIVAL");
            }
            if (scalar == arrival_table) {
                define("BOLUS_TABLE");
            }
            if (variant.depth) {
                define("DEPTH");
            }
            if (variant.thickness) {
                define("THICKNESS");
            }
            variants_.push_back(variant);
            programs_.push_back(std::move(program));
        }
    }
}

void GeometryEffect::visit(ParamVisitor& visitor) {
    params_.visit(visitor);
}

void GeometryEffect::validate() const {
    const VesselParams& vessel = params_.vessel;
    if (vessel.density == DensitySource::arrival_time && vessel.centreline.empty() && !vessel.injection_mm) {
        throw Error(ErrorCode::scene, "/vessel/injection_mm",
                    "is needed: without a centreline, contrast spreads over the surface from there");
    }
    if (params_.method != OverlapMethod::max && (outputs_.cloud || outputs_.distance)) {
        throw Error(ErrorCode::scene, "/method",
                    "only max draws several targets at once; draw contrast.main in a pass of its own");
    }
    if (params_.method == OverlapMethod::thickness &&
        (vessel.density != DensitySource::arrival_time || vessel.centreline.empty() ||
         vessel.full_calibre_mm == 0.0)) {
        throw Error(ErrorCode::scene, "/method",
                    "thickness needs a centreline, which knows radii, and the full_calibre_mm on which "
                    "contrast shows in full");
    }
    if (vessel.density == DensitySource::per_vertex && params_.delay_s > 0.0) {
        throw Error(ErrorCode::scene, "/delay_s", "densities given per vertex have no earlier time");
    }
}

std::vector<Port> GeometryEffect::ports() const {
    std::vector<Port> ports;
    if (outputs_.main) {
        ports.push_back(
            {.name = "main",
             .access = Access::write,
             .target = "contrast.main",
             .doc = "Opacity of the densest contrast on the way to the pixel, times its density."});
    }
    if (outputs_.cloud) {
        ports.push_back({.name = "cloud",
                         .access = Access::write,
                         .target = "contrast.cloud",
                         .doc = "Brightness and weight of the cloud around the injection.",
                         .format = PixelFormat::rg16f});
    }
    if (outputs_.distance) {
        ports.push_back({.name = "distance",
                         .access = Access::write,
                         .target = "contrast.distance",
                         .doc = "Closeness to the injection in [0, 1] on vessels, -1 beside them.",
                         .clear = {-1.0F, 0.0F, 0.0F, 0.0F}});
    }
    if (outputs_.main && params_.method == OverlapMethod::depth) {
        ports.push_back({.name = "depth",
                         .access = Access::write,
                         .target = "contrast.depth",
                         .doc = "Density of the fragment kept.",
                         .format = PixelFormat::depth32f});
    }
    return ports;
}

std::uint32_t GeometryEffect::port_bit(std::string_view port) const {
    const std::vector<Port> all = ports();
    const auto found = std::ranges::find(all, port, &Port::name);
    return found == all.end() ? 0U : 1U << (found - all.begin());
}

/// Takes the host's densities when there are any. False when the vessel holds no density at all.
bool GeometryEffect::update_density(Prepare& prepare) {
    const HostValues* values = prepare.frame().values;
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find(params_.vessel.scalar);
    if (given != nullptr && given->values.size() != vessel_->scalar.size()) {
        prepare.log().fault("contrast.host_density_count",
                            "host values '" + params_.vessel.scalar + "' have " +
                                std::to_string(given->values.size()) + " entries, the vessel has " +
                                std::to_string(vessel_->scalar.size()) + " vertices; they are not used");
        given = nullptr;
    }
    if (given == nullptr) {
        if (host_version_ != 0 || host_density_.empty()) {
            host_version_ = 0;
            host_density_ = vessel_->scalar;
            densest_ = host_density_.empty() ? 0.0F : *std::ranges::max_element(host_density_);
        }
    } else if (given->version != host_version_) {
        host_density_.assign(given->values.begin(), given->values.end());
        sanitise_density(host_density_, prepare.log());
        host_version_ = given->version;
        densest_ = *std::ranges::max_element(host_density_);
    }
    return densest_ > 0.0F;
}

bool GeometryEffect::makes_density(double since_start_s) const {
    if (vessel_->first_arrival_s > vessel_->last_arrival_s) {
        return false;
    }
    return !bolus_->zero_on(since_start_s - static_cast<double>(vessel_->last_arrival_s),
                            since_start_s - static_cast<double>(vessel_->first_arrival_s));
}

glm::dvec3 GeometryEffect::cloud_centre() const {
    return params_.cloud.centre_mm.value_or(vessel_->injection_mm);
}

/// The part of the vessel's box that the cloud reaches.
Bounds GeometryEffect::cloud_bounds() const {
    const glm::vec3 low(cloud_centre() - params_.cloud.radius_mm);
    const glm::vec3 high(cloud_centre() + params_.cloud.radius_mm);
    const Bounds bounds{glm::max(vessel_->bounds.min, low), glm::min(vessel_->bounds.max, high)};
    const bool apart = glm::any(glm::greaterThan(bounds.min, bounds.max));
    return apart ? Bounds{} : bounds;
}

Work GeometryEffect::prepare(Prepare& prepare) {
    if (parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        main_bits_ = port_bit("main") | port_bit("depth");
        cloud_bit_ = port_bit("cloud");
        distance_bit_ = port_bit("distance");
        bolus_.emplace(params_.bolus, prepare.log());
        bolus_table_key_ = Hash().bytes(std::as_bytes(std::span(bolus_->table().samples))).value();
        vessel_.reset();
        host_density_.clear();
    }
    const bool arrival = params_.vessel.density == DensitySource::arrival_time;
    since_start_s_ = prepare.frame().time_s - params_.delay_s - bolus_->start_s();
    brightness_ = params_.cloud.brightness * bolus_->density(since_start_s_);
    const bool injecting =
        brightness_ > 0.0 && brightness_ >= params_.cloud.threshold && params_.cloud.radius_mm > 0.0;
    if (params_.cloud.radius_mm == 0.0 && (outputs_.cloud || outputs_.distance)) {
        prepare.log().fault("contrast.cloud_radius", "the cloud's radius_mm is 0; no cloud is drawn");
    }
    // A bolus that has not begun needs no vessel: nothing is read.
    if (arrival && !injecting && bolus_->zero_on(-1e9, since_start_s_)) {
        return Work::idle("no contrast yet: the injection has not begun");
    }
    if (!vessel_) {
        vessel_ = load_vessel(prepare.assets(), params_.vessel);
    }
    if (vessel_->mesh.indices.empty()) {
        return Work::idle("the vessel has no triangles");
    }
    const bool dense = arrival ? makes_density(since_start_s_) : update_density(prepare);
    variant_ = {.scalar = Scalar::none,
                .cloud = outputs_.cloud && injecting && prepare.has("cloud"),
                .distance = outputs_.distance && injecting && prepare.has("distance"),
                .depth = params_.method == OverlapMethod::depth};
    if (outputs_.main && dense && prepare.has("main")) {
        variant_.scalar = !arrival                          ? Scalar::density
                          : bolus_->table().samples.empty() ? Scalar::arrival
                                                            : Scalar::arrival_table;
        variant_.thickness = params_.method == OverlapMethod::thickness;
        variant_.calibre = arrival && !vessel_->weight.empty() && !variant_.thickness;
    }
    if (variant_.scalar == Scalar::none && !variant_.cloud && !variant_.distance) {
        return Work::idle(outputs_.main ? "no contrast in the vessels at this time"
                                        : "no injection at this time");
    }
    std::uint32_t empty = 0;
    empty |= variant_.scalar == Scalar::none ? main_bits_ : 0U;
    empty |= variant_.cloud ? 0U : cloud_bit_;
    empty |= variant_.distance ? 0U : distance_bit_;

    const glm::dmat4 view_projection = prepare.frame().eye().view_projection();
    Hash key;
    key.add(parameters_key_).add(view_projection).add(brightness_).add(empty);
    if (!arrival) {
        key.add(host_version_);
    } else {
        // Where the density is the same all over the vessel, time does not matter: the plateau is one
        // picture.
        const DensityRange range =
            bolus_->range(since_start_s_ - static_cast<double>(vessel_->last_arrival_s),
                          since_start_s_ - static_cast<double>(vessel_->first_arrival_s));
        const bool constant = range.lower == range.upper && vessel_->last_arrival_s < unreached_s;
        key.add(constant ? range.lower : since_start_s_);
    }
    // One that is drawn: what nobody reads has no size.
    const std::string_view drawn = variant_.scalar != Scalar::none ? "main"
                                   : variant_.cloud                ? "cloud"
                                                                   : "distance";
    const glm::ivec2 size = prepare.size(drawn);
    const bool cloud_alone = outputs_.cloud && !outputs_.main && !outputs_.distance;
    const Bounds bounds = cloud_alone ? cloud_bounds() : vessel_->bounds;
    const PixelRect region = project_bounds(bounds, view_projection, size);
    if (region.empty()) {
        return Work::idle(cloud_alone ? "the cloud lies outside the view"
                                      : "the vessel lies outside the view");
    }
    const bool part = region != PixelRect{0, 0, size.x, size.y};
    const char* reason =
        cloud_alone ? "only where the cloud can be seen" : "only where the vessel can be seen";
    Work work = part ? Work::in_region(region, reason, key.value()) : Work::all(key.value());
    work.empty_outputs = empty;
    return work;
}

void GeometryEffect::sort_triangles(GpuVessel& gpu) {
    std::span<const float> densities = host_density_;
    if (params_.vessel.density == DensitySource::arrival_time) {
        vertex_density_.resize(vessel_->scalar.size());
        std::ranges::transform(vessel_->scalar, vertex_density_.begin(), [this](float tau) {
            return static_cast<float>(bolus_->density(since_start_s_ - static_cast<double>(tau)));
        });
        for (std::size_t i = 0; i < vessel_->weight.size(); ++i) {
            vertex_density_[i] *= vessel_->weight[i];
        }
        densities = vertex_density_;
    }
    painter_order(vessel_->mesh.indices, densities, PainterKey::max, scratch_, sorted_);
    gpu.mesh.update_indices(sorted_);
}

void GeometryEffect::draw(const Pass& pass) {
    // The painter reorders the triangles of its own copy only.
    const std::uint64_t key =
        Hash().add(vessel_.get()).add(params_.method == OverlapMethod::painter ? this : nullptr).value();
    GpuVessel& gpu = *pass.assets().shared<GpuVessel>(
        key, [&] { return std::make_shared<GpuVessel>(pass.gl(), vessel_); });
    if (variant_.scalar == Scalar::density && gpu.host_version != host_version_) {
        gpu.mesh.update_scalars("scalar", host_density_);
        gpu.mesh.select_scalar("scalar");
        gpu.host_version = host_version_;
    }
    const auto index = static_cast<std::size_t>(std::ranges::find(variants_, variant_) - variants_.begin());
    const gl::Program& program = pass.use(index);
    program.set("u_view_projection", glm::mat4(pass.frame().eye().view_projection()));
    program.set("u_tone", static_cast<float>(params_.tone));
    if (variant_.thickness) {
        const View& view = pass.frame().eye();
        program.set("u_eye", view.orthographic ? glm::vec4(-view.forward, 0.0) : glm::vec4(view.eye_mm, 1.0));
        program.set("u_inv_calibre",
                    static_cast<float>(std::min(1.0 / params_.vessel.full_calibre_mm, 1e30)));
    }
    program.set("u_time_since_start", static_cast<float>(since_start_s_));
    program.set("u_injection_point", glm::vec3(cloud_centre()));
    program.set("u_inv_radius",
                params_.cloud.radius_mm > 0.0 ? static_cast<float>(1.0 / params_.cloud.radius_mm) : 0.0F);
    program.set("u_brightness", static_cast<float>(brightness_));
    program.set("u_threshold", static_cast<float>(params_.cloud.threshold));
    if (variant_.scalar == Scalar::arrival_table) {
        const BolusTable& table = bolus_->table();
        // Passes that draw one vessel at different times share the table, too.
        const gl::Texture& samples = *pass.assets().shared<gl::Texture>(bolus_table_key_, [&] {
            auto made = std::make_shared<gl::Texture>(gl::Texture::make_2d(
                pass.gl(), static_cast<int>(table.samples.size()), 1, PixelFormat::r32f, "bolus table"));
            made->upload(std::as_bytes(std::span(table.samples)));
            return made;
        });
        pass.bind(program, "u_bolus_table", samples, gl::Filter::nearest);
        program.set("u_bolus_first", static_cast<float>(table.first_s));
        program.set("u_bolus_inv_step", static_cast<float>(1.0 / table.step_s));
    } else if (variant_.scalar == Scalar::arrival) {
        const Bolus::Uniforms& bolus = bolus_->uniforms();
        program.set("u_bolus_amplitude", bolus.amplitude);
        program.set("u_bolus_inv_rise", bolus.inv_rise);
        program.set("u_bolus_duration", bolus.duration);
        program.set("u_bolus_inv_washout", bolus.inv_washout);
        program.set("u_bolus_tail_scale", bolus.tail_scale);
        program.set("u_bolus_tail_offset", bolus.tail_offset);
    }
    switch (params_.method) {
        case OverlapMethod::max:
            pass.raster(gl::max_blend_state);
            break;
        case OverlapMethod::depth:
            pass.raster({.depth_test = GL_GREATER, .depth_write = true});
            break;
        case OverlapMethod::painter:
            sort_triangles(gpu);
            pass.raster(gl::overwrite_state);
            break;
        case OverlapMethod::thickness:
            pass.raster(gl::add_blend_state);
            break;
    }
    gpu.mesh.draw();
}

}  // namespace viscera::contrast
