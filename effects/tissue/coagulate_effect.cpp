#include "effects/tissue/coagulate_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "effects/tissue/list_texture.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/core/pixel_index.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {
namespace {

constexpr std::array<std::string_view, 2> metric_names{"world", "uv"};

// Bits of a program's index.
constexpr std::size_t in_uv = 1;
constexpr std::size_t long_ways = 2;
constexpr std::size_t in_steps = 4;
// The program for tiles that no contact reaches.
constexpr std::size_t untouched = 8;

// No place is farther than this from anything: the square of it is a float.
constexpr double no_limit = 1e18;
// Tiles are asked for a little farther than a contact reaches, since the shader measures in floats.
constexpr double wider = 1.0001;

}  // namespace

/// What the shader reads.
struct CoagulateEffect::Gpu {
    ListTexture tiles;
    ListTexture list;
    ListTexture contacts;
    std::optional<gl::Texture> saved;
    std::shared_ptr<const SavedEnergy> saved_of;
};

std::span<const std::string_view> choice_names(Metric) {
    return metric_names;
}

glm::vec4 packed_tile(int x, int y, std::uint32_t begin, std::uint32_t end) {
    static_assert(8192 / TileTree::tile_texels <= 1024, "the largest size has fewer tiles in a row");
    return {x + 1024 * y, begin >> 12U, begin & 4095U, end - begin};
}

void LimitParams::visit(ParamVisitor& v) {
    v.field({.name = "point_mm", .doc = "Its centre (u, v, 0 with metric uv).", .unit = "mm"}, point_mm);
    v.field({.name = "radius_mm", .doc = "Its radius.", .unit = "mm", .min = 0.0}, radius_mm);
}

void CoagulateParams::visit(ParamVisitor& v) {
    v.field(
        {.name = "mesh",
         .doc = "The mesh of the bake, by which a pass finds the part of the texture that a contact reaches; "
                "without it all is drawn."},
        mesh);
    visit_size(v, size);
    v.field({.name = "metric", .doc = "Where distances are measured: in the world [mm] or in the texture."},
            metric);
    v.field({.name = "contacts", .doc = "Contacts besides those of the host values `tissue.contacts`."},
            contacts);
    v.field({.name = "gain",
             .doc = "Whether power is the energy per second under a still contact (peak), or over all the "
                    "surface (normalised)."},
            gain);
    v.field({.name = "max_energy",
             .doc = "Beyond this ultrasound and dissection add nothing.",
             .min = 0.0,
             .max = 60000.0,
             .min_excluded = true},
            max_energy);
    v.field({.name = "max_speed_mm_s",
             .doc = "A host's contact that moved faster was lifted in between.",
             .unit = "mm/s",
             .min = 0.0},
            max_speed_mm_s);
    v.field({.name = "limit_to", .doc = "A ball outside which nothing changes."}, limit_to);
    v.field({.name = "load", .doc = "State to begin with."}, load);
}

CoagulateEffect::CoagulateEffect() {
    for (std::size_t variant = 0; variant < 8; ++variant) {
        ProgramDesc program{"tissue/coagulate.vert", "tissue/coagulate.frag", {}};
        if ((variant & in_uv) != 0) {
            program.defines.emplace_back("METRIC_UV");
        }
        if ((variant & long_ways) != 0) {
            program.defines.emplace_back("LONG_WAYS");
        }
        if ((variant & in_steps) != 0) {
            program.defines.emplace_back("IN_STEPS");
        }
        programs_.push_back(std::move(program));
    }
    programs_.push_back({"tissue/coagulate.vert", "tissue/coagulate_keep.frag", {}});
}
CoagulateEffect::~CoagulateEffect() = default;

void CoagulateEffect::validate() const {
    for (std::size_t i = 0; i < params_.contacts.size(); ++i) {
        if (!(params_.contacts[i].begin_s < params_.contacts[i].end_s)) {
            throw Error(ErrorCode::scene, "/contacts/" + std::to_string(i),
                        "must be switched off after it is switched on: begin_s < end_s");
        }
    }
}

std::vector<Port> CoagulateEffect::ports() const {
    std::vector<Port> ports{{.name = "energy",
                             .access = Access::write,
                             .target = "tissue.energy",
                             .doc = "Energy taken up: above 0 coagulated, below 0 dissected.",
                             .format = PixelFormat::r32f,
                             .size = square(params_.size),
                             .passthrough = "last",
                             .overwrites = true},
                            {.name = "last",
                             .access = Access::previous,
                             .target = "tissue.energy",
                             .doc = "The energy after the last frame."}};
    if (params_.metric == Metric::world) {
        ports.push_back(read_bake("position"));
    }
    return ports;
}

/// The tiles as the surface lies now; null: there are none for want of a mesh.
TileTree* CoagulateEffect::find_tiles(Prepare& prepare) {
    const int size = prepare.size("energy").x;
    if (params_.metric == Metric::uv) {
        if (!uv_tiles_ || uv_tiles_->size() != size) {
            uv_tiles_ = std::make_unique<TileTree>(size);
        }
        return uv_tiles_.get();
    }
    if (!params_.mesh) {
        return nullptr;
    }
    if (!surface_ || surface_->size() != size) {
        surface_ = BakedSurface::load(prepare.assets(), *params_.mesh, size);
    }
    surface_->check_bake(prepare, "tissue.coagulate");
    surface_->move(prepare);
    return &surface_->tiles(prepare.assets());
}

void CoagulateEffect::find_limit(const HostValues* values, Log& log) {
    limit_ = {0.0F, 0.0F, 0.0F, static_cast<float>(no_limit * no_limit)};
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find("tissue.limit_to");
    const auto is_finite = [](float value) { return std::isfinite(value); };
    if (given != nullptr && !(given->values.size() == 4 && std::ranges::all_of(given->values, is_finite) &&
                              given->values[3] >= 0.0F)) {
        log.fault("tissue.limit_to",
                  "host values 'tissue.limit_to' must be 4 finite numbers, a place and a radius that is not "
                  "negative; they are left out");
        given = nullptr;
    }
    if (given != nullptr) {
        const std::vector<float>& f = given->values;
        limit_ = {f[0], f[1], f[2], f[3] * f[3]};
    } else if (params_.limit_to) {
        limit_ = glm::vec4(glm::vec3(params_.limit_to->point_mm),
                           static_cast<float>(params_.limit_to->radius_mm * params_.limit_to->radius_mm));
    }
}

void CoagulateEffect::say_unusable(Log& log) const {
    if (contacts_.unusable() > 0) {
        log.fault(
            "tissue.contact",
            "contacts that are not finite, of no width, of an unknown action, or beyond 60,000 are left "
            "out",
            contacts_.unusable());
    }
    if (contacts_.unusable_places() > 0) {
        log.fault("tissue.contacts_from",
                  "host values 'tissue.contacts_from' must be 3 finite numbers for each of "
                  "'tissue.contacts'; all are left out if there are more or fewer, else those that are not "
                  "finite",
                  contacts_.unusable_places());
    }
    if (contacts_.is_long()) {
        log.fault("tissue.long_frame", "contacts act over a frame that takes more than 10 s");
    }
}

Work CoagulateEffect::prepare(Prepare& prepare) {
    const double time = prepare.frame().time_s;
    if (parameters_key_ != prepare.parameters_key()) {
        parameters_key_ = prepare.parameters_key();
        surface_.reset();
    }
    const int size = prepare.size("energy").x;
    if (params_.metric == Metric::world) {
        check_size(prepare, "energy");
    }
    values_ = prepare.frame().values;
    time_s_ = time;
    if (!last_time_s_) {
        // Parameters that were changed on the way make another effect, which goes on with what there is.
        began_ = prepare.has("last");
    } else if (!(time >= *last_time_s_)) {
        began_ = false;
        last_time_s_.reset();
        contacts_.forget_places();
    }
    std::shared_ptr<const SavedEnergy> saved;
    loads_ = !began_ && (prepare.has("last") || !params_.load.file.empty());
    if (loads_ && !params_.load.file.empty()) {
        saved = load_energy(prepare.assets(), params_.load, size);
        goes_on_s_ = saved->time_s.value_or(no_time);
        if (!last_time_s_ && saved->time_s && *saved->time_s <= time) {
            last_time_s_ = saved->time_s;
        }
    }
    contacts_.collect(params_.contacts, values_,
                      {.gain = params_.gain,
                       .max_speed = params_.metric == Metric::uv ? 1e30 : params_.max_speed_mm_s,
                       .begin_s = std::max(last_time_s_.value_or(time), goes_on_s_),
                       .end_s = time});
    say_unusable(prepare.log());
    find_limit(values_, prepare.log());
    const bool there = params_.metric == Metric::uv || prepare.has("position");
    if (!loads_ && (contacts_.contacts().empty() || !there)) {
        const bool still = last_time_s_ && !(time > *last_time_s_);
        const bool before = time < goes_on_s_;
        began_ = true;
        last_time_s_ = time;
        contacts_.keep_places(values_);
        return Work::idle(!there   ? "there is no surface"
                          : before ? "the loaded state is of a later time"
                          : still  ? "no time has passed"
                                   : "nothing touches the tissue");
    }
    if (!gpu_) {
        gpu_ = std::make_unique<Gpu>();
    }
    if (loads_ && saved != gpu_->saved_of) {
        gpu_->saved_of = saved;
        gpu_->saved.reset();
    }
    pack_contacts();
    TileTree* const tiles = find_tiles(prepare);
    if (tiles == nullptr) {
        // One tile that is the whole texture, with every contact.
        list_.clear();
        for (std::size_t i = 0; i < contacts_.contacts().size(); i += 4) {
            const auto n = static_cast<float>(i);
            list_.emplace_back(n, n + 1.0F, n + 2.0F, n + 3.0F);
        }
        drawn_tiles_.clear();
        const int side = (size + TileTree::tile_texels - 1) / TileTree::tile_texels;
        const auto count = static_cast<std::uint32_t>(contacts_.contacts().size());
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                drawn_tiles_.push_back(packed_tile(x, y, 0, count));
            }
        }
        touched_tiles_ = contacts_.contacts().empty() ? 0 : drawn_tiles_.size();
        return Work::all(0);
    }
    PixelRegion region;
    find_region(*tiles, region);
    if (loads_) {
        region = PixelRegion(PixelRect{0, 0, size, size});
    }
    if (region.empty()) {
        began_ = true;
        last_time_s_ = time;
        contacts_.keep_places(values_);
        return Work::idle("no contact reaches the tissue");
    }
    list_tiles(tiles->tiles_per_side(), region);
    return loads_ ? Work::all(0) : Work::update(region, "only what contacts reach", 0);
}

/// Pairs of a tile and a contact that may reach it, by contact, and the rectangles around the tiles.
void CoagulateEffect::find_region(TileTree& tiles, PixelRegion& region) {
    const int side = tiles.tiles_per_side();
    next_.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0);
    pair_tiles_.clear();
    pair_contacts_.clear();
    const glm::dvec3 limit(limit_);
    const double limit_radius = std::sqrt(static_cast<double>(limit_.w));
    for (std::size_t c = 0; c < contacts_.contacts().size(); ++c) {
        const Contact& contact = contacts_.contacts()[c];
        const double length = glm::distance(contact.from, contact.to);
        if (glm::distance(0.5 * (contact.from + contact.to), limit) >
            limit_radius + contact.reach + 0.5 * length) {
            continue;
        }
        found_.clear();
        tiles.near(contact.from, contact.to, wider * contact.reach, found_);
        for (const std::uint32_t tile : found_) {
            pair_tiles_.push_back(tile);
            pair_contacts_.push_back(static_cast<std::uint32_t>(c));
            ++next_[tile];
        }
    }
    constexpr int t = TileTree::tile_texels;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const int begin = x;
            while (x < side && next_[pixel_index(x, y, side)] > 0) {
                ++x;
            }
            region.add({begin * t, y * t, (x - begin) * t, t});
        }
    }
    region = region.confined(tiles.size(), tiles.size());
}

/// Every tile of the region, those that contacts reach first, with its contacts in the order of all contacts,
/// so that sums come out the same however the texture is divided.
void CoagulateEffect::list_tiles(int side, const PixelRegion& region) {
    constexpr int t = TileTree::tile_texels;
    list_.assign((pair_tiles_.size() + 3) / 4, glm::vec4(0.0F));
    std::uint32_t begin = 0;
    drawn_tiles_.clear();
    for (std::uint32_t& count : next_) {
        begin += std::exchange(count, begin);
    }
    for (const PixelRect& rect : region.rects()) {
        for (int y = rect.y / t; y * t < rect.y + rect.height; ++y) {
            for (int x = rect.x / t; x * t < rect.x + rect.width; ++x) {
                const auto tile = pixel_index(x, y, side);
                const std::uint32_t first = next_[tile];
                const std::uint32_t end = tile + 1 < next_.size() ? next_[tile + 1] : begin;
                drawn_tiles_.push_back(packed_tile(x, y, first, end));
            }
        }
    }
    const auto kept = std::partition(drawn_tiles_.begin(), drawn_tiles_.end(),
                                     [](const glm::vec4& tile) { return tile.w > 0.0F; });
    touched_tiles_ = static_cast<std::size_t>(kept - drawn_tiles_.begin());
    for (std::size_t p = 0; p < pair_tiles_.size(); ++p) {
        const std::uint32_t entry = next_[pair_tiles_[p]]++;
        list_[entry / 4][static_cast<int>(entry % 4)] = static_cast<float>(pair_contacts_[p]);
    }
}

void CoagulateEffect::pack_contacts() {
    packed_.clear();
    for (const Contact& contact : contacts_.contacts()) {
        const glm::dvec3 way = contact.to - contact.from;
        const double length = glm::length(way);
        const glm::dvec3 direction = length > 0.0 ? way / length : glm::dvec3(1.0, 0.0, 0.0);
        packed_.emplace_back(glm::vec3(0.5 * (contact.from + contact.to)), contact.dose);
        packed_.emplace_back(glm::vec3(direction), 0.5 * length);
        packed_.emplace_back(1.0 / contact.sigma, contact.reach * contact.reach, contact.action,
                             contact.step);
    }
}

void CoagulateEffect::draw(const Pass& pass) {
    const bool has_long_ways = std::ranges::any_of(contacts_.contacts(), [](const Contact& contact) {
        return glm::distance(contact.from, contact.to) > contact.sigma;
    });
    gpu_->tiles.upload(pass.gl(), drawn_tiles_, "tiles with contacts");
    gpu_->list.upload(pass.gl(), list_, "contacts of tiles");
    gpu_->contacts.upload(pass.gl(), packed_, "contacts");
    const std::size_t variant = (params_.metric == Metric::uv ? in_uv : 0) | (has_long_ways ? long_ways : 0) |
                                (contacts_.has_steps() ? in_steps : 0);
    draw_tiles(pass, variant, 0, touched_tiles_);
    draw_tiles(pass, untouched, touched_tiles_, drawn_tiles_.size());
    began_ = true;
    last_time_s_ = time_s_;
    contacts_.keep_places(values_);
}

void CoagulateEffect::draw_tiles(const Pass& pass, std::size_t variant, std::size_t first, std::size_t end) {
    if (first == end) {
        return;
    }
    const gl::Program& program = pass.use(variant);
    pass.bind(program, "u_tiles", gpu_->tiles.texture(), gl::Filter::nearest);
    if (variant != untouched) {
        pass.bind(program, "u_list", gpu_->list.texture(), gl::Filter::nearest);
        pass.bind(program, "u_contacts", gpu_->contacts.texture(), gl::Filter::nearest);
        program.set("u_e_max", static_cast<float>(params_.max_energy));
        program.set("u_limit", limit_);
        if (params_.metric == Metric::world) {
            pass.bind(program, "u_position", "position");
        }
    }
    if (loads_ && gpu_->saved_of) {
        if (!gpu_->saved) {
            gpu_->saved = gl::Texture::from_image(pass.gl(), gpu_->saved_of->image, "saved energy");
        }
        pass.bind(program, "u_last", *gpu_->saved, gl::Filter::nearest);
    } else {
        pass.bind(program, "u_last", "last");
    }
    program.set("u_keep", loads_ && !gpu_->saved_of ? 0.0F : 1.0F);
    program.set("u_size", static_cast<float>(pass.size().x));
    program.set("u_tile_texels", static_cast<float>(TileTree::tile_texels));
    program.set("u_first_tile", static_cast<int>(first));
    GLint bits = 0;
    pass.gl().GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                                                  GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, &bits);
    program.set("u_half", bits == 16);
    pass.draw_generated(GL_TRIANGLE_STRIP, 4, static_cast<int>(end - first));
}

}  // namespace viscera::tissue
