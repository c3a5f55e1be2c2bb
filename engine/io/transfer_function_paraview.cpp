#include <algorithm>
#include <array>
#include <optional>

#include "engine/core/json_text.h"
#include "engine/io/transfer_function_readers.h"

namespace viscera::io {
namespace {

struct NamedSpace {
    std::string_view name;
    ColourSpace space;
};
constexpr std::array<NamedSpace, 6> spaces{{{"RGB", ColourSpace::rgb},
                                            {"HSV", ColourSpace::hsv},
                                            {"Wrapped", ColourSpace::hsv_wrapped},
                                            {"Lab", ColourSpace::lab},
                                            {"CIELAB", ColourSpace::lab},
                                            {"Diverging", ColourSpace::diverging}}};

/// A flat list of numbers, four to a node.
class Quads {
  public:
    Quads(const JsonCursor& list, const char* form) : list_(list) {
        if (list.size() == 0 || list.size() % 4 != 0) {
            list.fail("must hold " + std::string(form) + " over and over, has " +
                      std::to_string(list.size()) + " numbers");
        }
        if (size() > most_vtk_nodes) {
            list.fail("has more than " + std::to_string(most_vtk_nodes) + " points");
        }
    }
    [[nodiscard]] std::size_t size() const { return list_.size() / 4; }
    [[nodiscard]] JsonCursor at(std::size_t node, std::size_t i) const { return list_.at(4 * node + i); }

  private:
    JsonCursor list_;
};

std::vector<VtkNode> colour_nodes(const JsonCursor& list) {
    const Quads quads(list, "value, red, green, blue");
    std::vector<VtkNode> nodes;
    for (std::size_t i = 0; i < quads.size(); ++i) {
        const auto number = [&](std::size_t k) { return quads.at(i, k).number(); };
        nodes.push_back({.x = number(0), .value = {number(1), number(2), number(3)}});
    }
    return nodes;
}

std::vector<VtkNode> opacity_nodes(const JsonCursor& list) {
    const Quads quads(list, "value, opacity, midpoint, sharpness");
    std::vector<VtkNode> nodes;
    for (std::size_t i = 0; i < quads.size(); ++i) {
        nodes.push_back({.x = quads.at(i, 0).number(),
                         .value = glm::dvec3(quads.at(i, 1).number()),
                         .midpoint = quads.at(i, 2).number(0.0, 1.0),
                         .sharpness = quads.at(i, 3).number(0.0, 1.0)});
    }
    return nodes;
}

std::vector<CurveKnot> colour_curve(const JsonCursor& map) {
    std::vector<VtkNode> nodes = colour_nodes(map.at("RGBPoints"));
    const std::optional<JsonCursor> space = map.find("ColorSpace");
    if (!space) {
        return straighten(std::move(nodes));
    }
    const std::string name = space->text();
    if (name == "Step") {
        return straighten_steps(std::move(nodes));
    }
    const auto known = std::ranges::find(spaces, name, &NamedSpace::name);
    if (known == spaces.end()) {
        space->fail("must be RGB, HSV, Wrapped, Lab, CIELAB, Diverging or Step, is " + quote(name));
    }
    const std::optional<JsonCursor> wrap = map.find("HSVWrap");
    const bool wrapped = known->space == ColourSpace::hsv && wrap && wrap->boolean();
    return straighten(std::move(nodes), wrapped ? ColourSpace::hsv_wrapped : known->space);
}

TransferFunction read_map(const JsonCursor& map) {
    TransferFunction function;
    if (const std::optional<JsonCursor> name = map.find("Name")) {
        function.name = name->text();
    }
    const std::vector<CurveKnot> colour = colour_curve(map);
    const std::optional<JsonCursor> points = map.find("Points");
    // A map without opacity gets ParaView's own: nothing at the low end, all at the high one.
    const std::vector<CurveKnot> opacity =
        points && points->size() > 0
            ? straighten(opacity_nodes(*points))
            : std::vector<CurveKnot>{{colour.front().x, glm::dvec3(0.0)}, {colour.back().x, glm::dvec3(1.0)}};
    function.points = merge(colour, opacity);
    return function;
}

}  // namespace

std::vector<TransferFunction> read_paraview(const JsonCursor& root, Log& log) {
    if (root.value().is_object()) {
        return {read_map(root)};
    }
    std::vector<TransferFunction> functions;
    std::optional<JsonCursor> categories;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < root.size(); ++i) {
        const JsonCursor map = root.at(i);
        if (!map.find("RGBPoints") && map.find("IndexedColors")) {
            categories = map.find("IndexedColors");
            ++left_out;
        } else {
            functions.push_back(read_map(map));
        }
    }
    if (functions.empty()) {
        if (categories) {
            categories->fail("colours for categories are no function of the value; RGBPoints are needed");
        }
        root.fail("holds no colour map");
    }
    if (left_out > 0) {
        log.fault("transfer function: maps of categories left out",
                  root.file().string() + ": " + categories->pointer() +
                      ": colours for categories are no function of the value",
                  left_out);
    }
    return functions;
}

}  // namespace viscera::io
