#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/runtime/frame.h"

namespace viscera::tissue {

/// What the current at a contact does to tissue.
enum class ContactAction { coagulate, ultrasound, dissect };
[[nodiscard]] std::span<const std::string_view> choice_names(ContactAction action);

/// A contact that the scene describes: it moves at one speed from one place to another.
struct ContactParams {
    glm::dvec3 from_mm{0.0};
    std::optional<glm::dvec3> to_mm;
    double begin_s = 0.0;
    double end_s = 1e9;
    double power = 1.0;
    double sigma_mm = 2.0;
    ContactAction action = ContactAction::coagulate;

    void visit(ParamVisitor& v);
};

/// One contact in one frame: energy spread around the way that it went.
struct Contact {
    glm::dvec3 from{0.0};  ///< [mm], or UV
    glm::dvec3 to{0.0};
    double dose = 0.0;   ///< P dt G: what a point under a still contact gets
    double sigma = 0.0;  ///< of the Gaussian, in the unit of the places
    double reach = 0.0;  ///< beyond this from the way nothing is added
    ContactAction action = ContactAction::coagulate;
    double begin_s = 0.0;  ///< when it acts
    double end_s = 0.0;
    int step = 0;  ///< contacts of one step act at once, steps one after the other
};

/// How the power of a contact is meant.
enum class Gain {
    peak,        ///< G = 1: energy per second under a still contact
    normalised,  ///< G = 1 / (2 pi sigma^2): energy per second times area, over all the surface
};
[[nodiscard]] std::span<const std::string_view> choice_names(Gain gain);

/// The distance from a contact's way up to which its Gaussian is drawn; 0 when it is too weak anywhere.
/// `rate`: P G [1/s]. Beyond it a contact adds less than half a unit in the last place of 1 in 1/60 s. The
/// time is fixed, so that the same texels are touched at any frame rate.
[[nodiscard]] double contact_reach(double rate, double sigma);

/// The contacts of each frame, from the scene and the host.
class ContactList {
  public:
    /// Host array `tissue.contacts`: x, y, z [mm] (or u, v, 0), power [1/s], sigma [mm] (or of UV), action
    /// (0 coagulate, 1 ultrasound, 2 dissect). A negative power with action 0 dissects, too.
    static constexpr std::size_t floats_per_contact = 6;
    /// Host array `tissue.contacts_from`: where each of them was at the frame before.
    static constexpr std::size_t floats_per_place = 3;

    struct Settings {
        Gain gain = Gain::peak;
        double max_speed = 1000.0;  ///< [mm/s]; faster ones are taken to have been lifted
        /// The frame's interval of time: (begin_s, end_s].
        double begin_s = 0.0;
        double end_s = 0.0;
    };
    /// Contacts in one list at most: glsl/tissue/coagulate.frag goes through them in one loop, and llvmpipe
    /// ends loops silently after 65,535 rounds. Beyond it they are cut off and counted as unusable.
    static constexpr std::size_t most_contacts = 60000;

    /// All that act in the interval, in an order that does not hang on the order they are given in.
    /// Contact i of a frame goes on from contact i of the frame before, unless that one was off, did
    /// something else, or the host tells where it was. Allocates nothing once every count has occurred.
    void collect(std::span<const ContactParams> scene, const HostValues* values, const Settings& settings);
    /// The frame has been drawn: its places are where the next one's begin. `values` as collect() had them.
    void keep_places(const HostValues* values);
    /// Contacts of the next frame begin where they are.
    void forget_places() { last_.clear(); }

    /// By step, and within one by action. Sums of several contacts are cut off and their actions hang on each
    /// other from moment to moment: where contacts that move or act differently may reach one place, the
    /// interval is taken in steps of 1/240 s, so that a long frame does what short ones do: in 60 steps at
    /// most, and in no more than keep within most_contacts.
    [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }
    [[nodiscard]] bool has_steps() const { return !contacts_.empty() && contacts_.back().step > 0; }
    /// Contacts of the last collect() that were left out: not finite, of no width, of an unknown action, or
    /// cut off.
    [[nodiscard]] std::uint64_t unusable() const { return unusable_; }
    /// Places of the frame before that were left out: not finite, or (counted once) not one for each contact.
    [[nodiscard]] std::uint64_t unusable_places() const { return unusable_places_; }
    /// Whether contacts act over so long that the times are likely to be in another unit.
    [[nodiscard]] bool is_long() const { return is_long_; }

  private:
    struct Place {
        glm::dvec3 at{0.0};
        ContactAction action = ContactAction::coagulate;
        bool on = false;
    };
    void add_scene(const ContactParams& params, const Settings& settings);
    void add_host(const HostValues& values, const Settings& settings);
    void add(const Contact& contact, double power, Gain gain);
    [[nodiscard]] const HostValues::Entry* places_before(const HostValues& values, std::size_t contacts);
    [[nodiscard]] bool hang_together() const;
    void split(const Settings& settings);

    std::vector<Contact> contacts_;
    std::vector<Contact> whole_;  ///< before they are split into steps
    std::vector<Place> last_;
    std::uint64_t unusable_ = 0;
    std::uint64_t unusable_places_ = 0;
    bool is_long_ = false;
};

}  // namespace viscera::tissue
