#include "tests/reference/volume_exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace viscera::reference {
namespace {

constexpr std::size_t points = 5;

double legendre(std::size_t n, double x) {
    double before = 1.0;
    double now = x;
    if (n == 0) {
        return before;
    }
    for (std::size_t k = 1; k < n; ++k) {
        const auto m = static_cast<double>(k);
        before = std::exchange(now, ((2.0 * m + 1.0) * x * now - m * before) / (m + 1.0));
    }
    return now;
}

/// Gauss's rule of five points on [-1, 1], with what integrates its interpolant up to each node.
struct Gauss {
    std::array<double, points> x{};
    std::array<double, points> weight{};
    std::array<std::array<double, points>, points> partial{};  ///< [i][j]: int_-1^x_i of cardinal j
    std::array<double, points> highest{};  ///< gives the interpolant's Legendre coefficient of degree 4
    /// Gives the interpolant at places where it is checked, which are no nodes.
    static constexpr std::array<double, 2> check_x{-0.98, 0.98};
    std::array<std::array<double, points>, check_x.size()> check{};

    Gauss() {
        const double a = 2.0 * std::sqrt(10.0 / 7.0);
        const double inner = std::sqrt(5.0 - a) / 3.0;
        const double outer = std::sqrt(5.0 + a) / 3.0;
        const double root = 13.0 * std::sqrt(70.0);
        x = {-outer, -inner, 0.0, inner, outer};
        weight = {(322.0 - root) / 900.0, (322.0 + root) / 900.0, 128.0 / 225.0, (322.0 + root) / 900.0,
                  (322.0 - root) / 900.0};
        for (std::size_t j = 0; j < points; ++j) {
            highest[j] = 4.5 * weight[j] * legendre(4, x[j]);
            for (std::size_t i = 0; i < points; ++i) {
                // int_-1^x P_n = (P_(n+1) - P_(n-1)) / (2n + 1); P_0 gives x + 1.
                double sum = 0.5 * weight[j] * (x[i] + 1.0);
                for (std::size_t n = 1; n < points; ++n) {
                    sum +=
                        0.5 * weight[j] * legendre(n, x[j]) * (legendre(n + 1, x[i]) - legendre(n - 1, x[i]));
                }
                partial[i][j] = sum;
            }
            for (std::size_t i = 0; i < check_x.size(); ++i) {
                for (std::size_t n = 0; n < points; ++n) {
                    check[i][j] += (static_cast<double>(n) + 0.5) * weight[j] * legendre(n, x[j]) *
                                   legendre(n, check_x[i]);
                }
            }
        }
    }
};

const Gauss& gauss() {
    static const Gauss rule;
    return rule;
}

/// A stretch of a piece within one segment of the medium.
struct Stretch {
    const Polynomial& value;
    const Medium& medium;
    std::size_t segment;
    double half_mm;  ///< ds/du
};

/// Calls use(u0, u1, segment) for the stretches of a piece between the medium's knots, in order.
template <class Use>
void split_at_knots(const Polynomial& value, const Medium& medium, Use&& use) {
    const Bounds reach = bounds(value);
    const std::size_t first = medium.segment_of(reach.low);
    const std::size_t last = medium.segment_of(reach.high);
    if (medium.transparent(first, last)) {
        return;
    }
    if (first == last) {
        use(-1.0, 1.0, first);
        return;
    }
    std::vector<double> cuts{-1.0, 1.0};
    for (std::size_t i = first; i < last; ++i) {
        Polynomial shifted = value;
        shifted.c[0] -= medium.knots()[i];
        const Roots roots = sign_changes(shifted, -1.0, 1.0);
        cuts.insert(cuts.end(), roots.begin(), roots.end());
    }
    std::ranges::sort(cuts);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i] < cuts[i + 1]) {
            const std::size_t segment = medium.segment_of(value(0.5 * (cuts[i] + cuts[i + 1])));
            if (!medium.transparent(segment, segment)) {
                use(cuts[i], cuts[i + 1], segment);
            }
        }
    }
}

/// How large what the rule leaves unsure may be: it is of order ten where its interpolant is of order five,
/// so its error is about the square.
double unsure_allowed(const Quality& quality) {
    return 0.03 * std::sqrt(quality.tolerance);
}

/// The rule's emissions over part of a stretch.
struct Sampled {
    std::array<Emission, points> e;
    double mm = 0.0;      ///< ds per unit of the rule
    double depth = 0.0;   ///< int kappa ds
    double unsure = 0.0;  ///< how far the interpolant through the nodes may be off, times mm
};

/// One number that follows extinction and colour.
double mixed(const Emission& e) {
    return e.extinction * (1.0 + 0.3 * e.colour.x + 0.37 * e.colour.y + 0.33 * e.colour.z);
}

Sampled sampled(const Stretch& stretch, double u0, double u1) {
    const Gauss& rule = gauss();
    const double middle = 0.5 * (u0 + u1);
    const double half = 0.5 * (u1 - u0);
    const auto at = [&](double x) {
        return stretch.medium.at(stretch.value(middle + half * x), stretch.segment);
    };
    Sampled result;
    result.mm = half * stretch.half_mm;
    double highest = 0.0;
    std::array<double, Gauss::check_x.size()> expected{};
    for (std::size_t i = 0; i < points; ++i) {
        result.e[i] = at(rule.x[i]);
        result.depth += rule.weight[i] * result.e[i].extinction;
        const double seen = mixed(result.e[i]);
        highest += rule.highest[i] * seen;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            expected[k] += rule.check[k][i] * seen;
        }
    }
    double worst = std::abs(highest);
    for (std::size_t k = 0; k < expected.size(); ++k) {
        worst = std::max(worst, std::abs(expected[k] - mixed(at(Gauss::check_x[k]))));
    }
    result.depth *= result.mm;
    result.unsure = worst * result.mm;
    return result;
}

void advance_stretch(Light& light, const Stretch& stretch, double u0, double u1, double allowed,
                     int halvings) {
    const Sampled now = sampled(stretch, u0, u1);
    if (halvings > 0 && light.transmittance > 0.0 &&
        (light.transmittance * now.unsure > allowed || now.depth > 1.0)) {
        const double middle = 0.5 * (u0 + u1);
        advance_stretch(light, stretch, u0, middle, allowed, halvings - 1);
        advance_stretch(light, stretch, middle, u1, allowed, halvings - 1);
        return;
    }
    const Gauss& rule = gauss();
    for (std::size_t i = 0; i < points; ++i) {
        double before = 0.0;
        for (std::size_t j = 0; j < points; ++j) {
            before += rule.partial[i][j] * now.e[j].extinction;
        }
        light.colour += light.transmittance * now.mm * rule.weight[i] * now.e[i].extinction *
                        std::exp(-now.mm * before) * now.e[i].colour;
    }
    light.transmittance *= std::exp(-now.depth);
}

double depth_of_stretch(const Stretch& stretch, double u0, double u1, double allowed, int halvings) {
    const Sampled now = sampled(stretch, u0, u1);
    if (halvings > 0 && now.unsure > allowed) {
        const double middle = 0.5 * (u0 + u1);
        return depth_of_stretch(stretch, u0, middle, allowed, halvings - 1) +
               depth_of_stretch(stretch, middle, u1, allowed, halvings - 1);
    }
    return now.depth;
}

constexpr int most_halvings = 40;

/// Calls use(u0, u1) for the stretches of a piece where the value is >= iso.
template <class Use>
void where_kept(const Piece& piece, std::optional<double> iso, Use&& use) {
    if (!iso) {
        use(-1.0, 1.0);
        return;
    }
    Polynomial shifted = piece.value;
    shifted.c[0] -= *iso;
    const Roots roots = sign_changes(shifted, -1.0, 1.0);
    bool kept = shifted(-1.0) >= 0.0;
    double u = -1.0;
    for (const double root : roots) {
        if (kept) {
            use(u, root);
        }
        kept = !kept;
        u = root;
    }
    if (kept) {
        use(u, 1.0);
    }
}

/// Visits the crossings of one piece and of its beginning. `inside` says for each iso value on which side the
/// ray is, so that rounding between pieces neither loses nor doubles a crossing.
class CrossingFinder {
  public:
    explicit CrossingFinder(std::span<const double> isos) : isos_(isos), inside_(isos.size()) {}

    struct Found {
        double s_mm;
        double iso;
        bool rising;
    };

    void visit(const Piece& piece, std::vector<Found>& found) {
        const Bounds reach = bounds(piece.value);
        const std::size_t before = found.size();
        for (std::size_t i = 0; i < isos_.size(); ++i) {
            const double iso = isos_[i];
            const bool above = reach.low >= iso;
            bool inside = above;
            Roots roots;
            if (!above && reach.high >= iso) {
                Polynomial shifted = piece.value;
                shifted.c[0] -= iso;
                inside = shifted(-1.0) >= 0.0;
                roots = sign_changes(shifted, -1.0, 1.0);
            }
            if (!first_ && inside != static_cast<bool>(inside_[i])) {
                found.push_back({piece.s.begin, iso, inside});
            }
            for (const double root : roots) {
                inside = !inside;
                found.push_back({piece.s_of(root), iso, inside});
            }
            inside_[i] = inside;
        }
        first_ = false;
        std::ranges::stable_sort(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(), {},
                                 &Found::s_mm);
    }

  private:
    std::span<const double> isos_;
    std::vector<char> inside_;
    bool first_ = true;
};

}  // namespace

void advance(Light& light, const Piece& piece, const Medium& medium, const Quality& quality) {
    const double allowed = unsure_allowed(quality);
    split_at_knots(piece.value, medium, [&](double u0, double u1, std::size_t segment) {
        advance_stretch(light, {piece.value, medium, segment, piece.half_mm()}, u0, u1, allowed,
                        most_halvings);
    });
}

Light composite(const Field& field, const Ray& ray, const Interval& interval, const Medium& medium,
                const Quality& quality) {
    Light light;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        advance(light, piece, medium, quality);
        return light.transmittance > quality.stop_transmittance;
    });
    return light;
}

double optical_depth(const Field& field, const Ray& ray, const Interval& interval, const Medium& medium,
                     const Quality& quality) {
    double sum = 0.0;
    const double allowed = unsure_allowed(quality);
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        split_at_knots(piece.value, medium, [&](double u0, double u1, std::size_t segment) {
            sum += depth_of_stretch({piece.value, medium, segment, piece.half_mm()}, u0, u1, allowed,
                                    most_halvings);
        });
        return true;
    });
    return sum;
}

double xray(const Field& field, const Ray& ray, const Interval& interval, const Medium& mu,
            const Quality& quality) {
    return std::exp(-optical_depth(field, ray, interval, mu, quality));
}

double line_integral(const Field& field, const Ray& ray, const Interval& interval) {
    double sum = 0.0;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        sum += piece.half_mm() * piece.value.integral(-1.0, 1.0);
        return true;
    });
    return sum;
}

std::optional<double> maximum(const Field& field, const Ray& ray, const Interval& interval,
                              std::optional<double> iso) {
    double best = -std::numeric_limits<double>::infinity();
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        if (bounds(piece.value).high > best) {
            best = std::max(best, extremes(piece.value, -1.0, 1.0).high);
        }
        return true;
    });
    return best >= iso.value_or(best) ? std::optional(best) : std::nullopt;
}

std::optional<double> minimum(const Field& field, const Ray& ray, const Interval& interval,
                              std::optional<double> iso) {
    std::optional<double> best;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        where_kept(piece, iso, [&](double u0, double u1) {
            // A root may lie on the wrong side by a rounding error.
            const double low = std::max(extremes(piece.value, u0, u1).low, iso.value_or(-1e308));
            best = best ? std::min(*best, low) : low;
        });
        return true;
    });
    return best;
}

std::optional<double> mean(const Field& field, const Ray& ray, const Interval& interval,
                           std::optional<double> iso) {
    double sum = 0.0;
    double length = 0.0;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        where_kept(piece, iso, [&](double u0, double u1) {
            sum += piece.half_mm() * piece.value.integral(u0, u1);
            length += piece.half_mm() * (u1 - u0);
        });
        return true;
    });
    return length > 0.0 ? std::optional(sum / length) : std::nullopt;
}

Crossing crossing_at(const Field& field, const Ray& ray, double s_mm, double iso, bool rising) {
    Crossing crossing{s_mm, iso};
    crossing.position_mm = ray.at(s_mm);
    crossing.texture = glm::dvec3(field.world_to_texture() * glm::dvec4(crossing.position_mm, 1.0));
    crossing.gradient = field.to_world_gradient(field.gradient(crossing.texture));
    const double steepness = glm::length(crossing.gradient);
    crossing.normal = steepness > 0.0 ? -crossing.gradient / steepness : glm::dvec3(0.0);
    crossing.rising = rising;
    return crossing;
}

std::optional<Crossing> first_crossing(const Field& field, const Ray& ray, const Interval& interval,
                                       double iso) {
    CrossingFinder finder(std::span(&iso, 1));
    std::vector<CrossingFinder::Found> found;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        finder.visit(piece, found);
        return found.empty();
    });
    if (found.empty()) {
        return {};
    }
    return crossing_at(field, ray, found.front().s_mm, iso, found.front().rising);
}

std::vector<Crossing> crossings(const Field& field, const Ray& ray, const Interval& interval,
                                std::span<const double> isos) {
    CrossingFinder finder(isos);
    std::vector<CrossingFinder::Found> found;
    visit_pieces(field, ray, interval, [&](const Piece& piece) {
        finder.visit(piece, found);
        return true;
    });
    std::vector<Crossing> result;
    result.reserve(found.size());
    for (const auto& [s_mm, iso, rising] : found) {
        result.push_back(crossing_at(field, ray, s_mm, iso, rising));
    }
    return result;
}

}  // namespace viscera::reference
