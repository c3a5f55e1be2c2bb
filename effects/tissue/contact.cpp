#include "effects/tissue/contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/core/finite.h"

namespace viscera::tissue {
namespace {

constexpr std::array<std::string_view, 3> action_names{"coagulate", "ultrasound", "dissect"};
constexpr std::array<std::string_view, 2> gain_names{"peak", "normalised"};

// Smaller Gaussians than this have no square in a float.
constexpr double smallest_sigma = 1e-18;
// A dose beyond this has the same effect, and sums of 65,000 of them stay finite in a float.
constexpr double largest_dose = 1e30;

/// Where a contact stands in the order that sums are formed in.
auto rank(const Contact& c) {
    return std::tuple(c.step, c.action, c.from.x, c.from.y, c.from.z, c.to.x, c.to.y, c.to.z, c.dose,
                      c.sigma);
}

/// What one contact of a host's array does; none when it cannot be used.
std::optional<ContactAction> action_of(float code, float power) {
    if (!(code == 0.0F || code == 1.0F || code == 2.0F)) {
        return std::nullopt;
    }
    return code == 0.0F && power < 0.0F ? ContactAction::dissect : static_cast<ContactAction>(code);
}

}  // namespace

std::span<const std::string_view> choice_names(ContactAction) {
    return action_names;
}
std::span<const std::string_view> choice_names(Gain) {
    return gain_names;
}

void ContactParams::visit(ParamVisitor& v) {
    v.field({.name = "from_mm", .doc = "Where it begins (u, v, 0 with metric uv).", .unit = "mm"}, from_mm);
    v.field({.name = "to_mm", .doc = "Where it ends, by default where it begins.", .unit = "mm"}, to_mm);
    v.field({.name = "begin_s", .doc = "When the current is switched on.", .unit = "s"}, begin_s);
    v.field({.name = "end_s", .doc = "When it is switched off.", .unit = "s"}, end_s);
    v.field({.name = "power", .doc = "Energy per second, as gain says.", .unit = "1/s", .min = 0.0}, power);
    v.field({.name = "sigma_mm",
             .doc = "Width of the Gaussian around it (of UV with metric uv).",
             .unit = "mm",
             .min = 0.0},
            sigma_mm);
    v.field({.name = "action", .doc = "What it does."}, action);
}

double contact_reach(double rate, double sigma) {
    constexpr double usual_frame_s = 1.0 / 60.0;
    constexpr double half_unit = 0x1p-24;
    const double ratio = rate * usual_frame_s / half_unit;
    return ratio > 1.0 ? sigma * std::sqrt(2.0 * std::log(ratio)) : 0.0;
}

void ContactList::add(const Contact& contact, double power, Gain gain) {
    const double seconds = contact.end_s - contact.begin_s;
    // Written so that NaN is left out.
    if (!(power > 0.0 && seconds > 0.0)) {
        return;
    }
    if (!(contact.sigma > smallest_sigma)) {
        ++unusable_;
        return;
    }
    const double g =
        gain == Gain::peak ? 1.0 : 1.0 / (2.0 * std::numbers::pi * contact.sigma * contact.sigma);
    Contact added = contact;
    added.reach = contact_reach(std::min(power * g, largest_dose), contact.sigma);
    added.dose = std::min(power * g * seconds, largest_dose);
    if (added.reach > 0.0) {
        contacts_.push_back(added);
    }
}

void ContactList::add_scene(const ContactParams& params, const Settings& settings) {
    const double begin = std::max(settings.begin_s, params.begin_s);
    const double end = std::min(settings.end_s, params.end_s);
    if (!(begin < end)) {
        return;
    }
    const glm::dvec3 way = params.to_mm.value_or(params.from_mm) - params.from_mm;
    const auto place = [&](double time) {
        return params.from_mm + way * ((time - params.begin_s) / (params.end_s - params.begin_s));
    };
    add({.from = place(begin),
         .to = place(end),
         .sigma = params.sigma_mm,
         .action = params.action,
         .begin_s = begin,
         .end_s = end},
        params.power, settings.gain);
}

/// Null: the host gives none, or not one for each contact.
const HostValues::Entry* ContactList::places_before(const HostValues& values, std::size_t contacts) {
    const HostValues::Entry* given = values.find("tissue.contacts_from");
    const bool fits =
        given == nullptr || contacts == 0 || given->values.size() == contacts * floats_per_place;
    unusable_places_ += fits ? 0 : 1;
    return fits ? given : nullptr;
}

void ContactList::add_host(const HostValues& values, const Settings& settings) {
    const HostValues::Entry* given = values.find("tissue.contacts");
    if (given == nullptr) {
        return;
    }
    const double seconds = settings.end_s - settings.begin_s;
    const std::size_t count = given->values.size() / floats_per_contact;
    const HostValues::Entry* before = places_before(values, count);
    unusable_ += given->values.size() % floats_per_contact != 0 ? 1 : 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto f = std::span(given->values).subspan(i * floats_per_contact, floats_per_contact);
        Contact contact{
            .to = {f[0], f[1], f[2]}, .sigma = f[4], .begin_s = settings.begin_s, .end_s = settings.end_s};
        const std::optional<ContactAction> action = action_of(f[5], f[3]);
        if (!action || !finite(contact.to) || !finite(f[3]) || !finite(f[4])) {
            ++unusable_;
            continue;
        }
        contact.action = *action;
        contact.from = contact.to;
        const double power = action == ContactAction::dissect ? std::abs(f[3]) : f[3];
        if (before != nullptr) {
            const auto b = std::span(before->values).subspan(i * floats_per_place, floats_per_place);
            const glm::dvec3 from(b[0], b[1], b[2]);
            unusable_places_ += finite(from) ? 0 : 1;
            contact.from = finite(from) ? from : contact.to;
        } else if (i < last_.size() && last_[i].on && last_[i].action == *action &&
                   glm::distance(last_[i].at, contact.to) <= settings.max_speed * seconds) {
            contact.from = last_[i].at;
        }
        add(contact, power, settings.gain);
    }
}

void ContactList::collect(std::span<const ContactParams> scene, const HostValues* values,
                          const Settings& settings) {
    contacts_.clear();
    unusable_ = 0;
    unusable_places_ = 0;
    for (const ContactParams& params : scene) {
        add_scene(params, settings);
    }
    if (values != nullptr) {
        add_host(*values, settings);
    }
    if (contacts_.size() > most_contacts) {
        unusable_ += contacts_.size() - most_contacts;
        contacts_.resize(most_contacts);
    }
    constexpr double long_s = 10.0;
    is_long_ = !contacts_.empty() && settings.end_s - settings.begin_s > long_s;
    if (hang_together()) {
        split(settings);
    }
    std::ranges::sort(contacts_, {}, rank);
}

/// Whether two contacts that move or act differently may reach one place. Of many contacts only that some
/// move or act differently is looked at.
bool ContactList::hang_together() const {
    constexpr std::size_t most_compared = 256;
    const auto moves = [](const Contact& c) { return c.from != c.to; };
    const auto differ = [&](const Contact& a, const Contact& b) {
        return a.action != b.action || moves(a) || moves(b) || a.begin_s != b.begin_s || a.end_s != b.end_s;
    };
    if (contacts_.size() > most_compared) {
        return std::ranges::any_of(contacts_, [&](const Contact& c) { return differ(c, contacts_.front()); });
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Contact& a = contacts_[i];
            const Contact& b = contacts_[j];
            const double apart = glm::distance(0.5 * (a.from + a.to), 0.5 * (b.from + b.to));
            const double reached =
                a.reach + b.reach + 0.5 * (glm::distance(a.from, a.to) + glm::distance(b.from, b.to));
            if (differ(a, b) && !(apart > reached)) {
                return true;
            }
        }
    }
    return false;
}

/// Into steps of the interval, each contact for the part of a step in which it acts.
void ContactList::split(const Settings& settings) {
    constexpr double steps_per_second = 240.0;
    constexpr double longest_in_steps_s = 0.25;
    const double seconds = settings.end_s - settings.begin_s;
    // A length that is a whole number of steps but for rounding has no further one.
    double steps = std::ceil(std::min(seconds, longest_in_steps_s) * steps_per_second - 1e-6);
    const std::size_t most_steps = most_contacts / contacts_.size();
    steps = std::min(steps, static_cast<double>(most_steps));
    if (!(steps > 1.0)) {
        return;
    }
    whole_.swap(contacts_);
    contacts_.clear();
    for (int s = 0; s < static_cast<int>(steps); ++s) {
        const double from_s = settings.begin_s + seconds * (s / steps);
        const double to_s = settings.begin_s + seconds * ((s + 1) / steps);
        for (const Contact& contact : whole_) {
            Contact part = contact;
            part.begin_s = std::max(from_s, contact.begin_s);
            part.end_s = std::min(to_s, contact.end_s);
            if (!(part.begin_s < part.end_s)) {
                continue;
            }
            const double length = contact.end_s - contact.begin_s;
            const double a = (part.begin_s - contact.begin_s) / length;
            const double b = (part.end_s - contact.begin_s) / length;
            part.from = glm::mix(contact.from, contact.to, a);
            part.to = glm::mix(contact.from, contact.to, b);
            part.dose = contact.dose * (b - a);
            part.step = s;
            contacts_.push_back(part);
        }
    }
}

void ContactList::keep_places(const HostValues* values) {
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find("tissue.contacts");
    last_.clear();
    if (given == nullptr) {
        return;
    }
    for (std::size_t i = 0; i + floats_per_contact <= given->values.size(); i += floats_per_contact) {
        const std::span<const float> f = std::span(given->values).subspan(i, floats_per_contact);
        const glm::dvec3 at(f[0], f[1], f[2]);
        const std::optional<ContactAction> action = action_of(f[5], f[3]);
        const bool on = action && finite(at) && finite(f[3]) && f[3] != 0.0F;
        last_.push_back({at, action.value_or(ContactAction::coagulate), on});
    }
}

}  // namespace viscera::tissue
