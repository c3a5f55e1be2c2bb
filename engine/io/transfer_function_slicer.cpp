#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/json_text.h"
#include "engine/io/transfer_function_readers.h"
#include "engine/io/words.h"

namespace viscera::io {
namespace {

/// The lines of a .vp file, taken one after another.
class VpLines {
  public:
    VpLines(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

    [[nodiscard]] double number(const char* key) {
        std::string_view line = take(key);
        return word(line, key);
    }

    /// The numbers behind their count, a multiple of `group`.
    [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t group) {
        std::string_view line = take(key);
        const double count = word(line, key);
        if (!(count >= 0.0 && count == std::floor(count) &&
              std::fmod(count, static_cast<double>(group)) == 0.0)) {
            fail(key, "count must be a multiple of " + std::to_string(group) + ", is " + number_text(count));
        }
        if (count > static_cast<double>(most_vtk_nodes * group)) {
            fail(key, "has more than " + std::to_string(most_vtk_nodes) + " points");
        }
        std::vector<double> values(static_cast<std::size_t>(count));
        for (double& value : values) {
            value = word(line, key);
        }
        if (!take_word(line).empty()) {
            fail(key, "has more numbers than its count " + number_text(count));
        }
        return values;
    }

    [[noreturn]] void fail(const char* key, const std::string& message) const {
        throw Error(ErrorCode::file, file_.string(),
                    "line " + std::to_string(line_) + ", " + key + ": " + message);
    }

  private:
    std::string_view take(const char* key) {
        ++line_;
        if (text_.empty()) {
            fail(key, "is missing");
        }
        return take_line(text_);
    }

    double word(std::string_view& line, const char* key) const {
        const std::string_view text = take_word(line);
        if (text.empty()) {
            fail(key, "ends too early");
        }
        const std::optional<double> value = to_number(text);
        if (!value || !std::isfinite(*value)) {
            fail(key, "must be a finite number, is " + quote(text));
        }
        return *value;
    }

    const std::filesystem::path& file_;
    std::string_view text_;
    int line_ = 0;
};

std::vector<VtkNode> nodes_of(const std::vector<double>& numbers) {
    std::vector<VtkNode> nodes;
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
        nodes.push_back({.x = numbers[i], .value = glm::dvec3(numbers[i + 1])});
    }
    return nodes;
}

/// A function's "points", with their values under `y` or `color`.
std::vector<VtkNode> json_nodes(const JsonCursor& function) {
    const JsonCursor points = function.at("points");
    if (points.size() > most_vtk_nodes) {
        points.fail("has more than " + std::to_string(most_vtk_nodes) + " points");
    }
    std::vector<VtkNode> nodes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const JsonCursor point = points.at(i);
        VtkNode node{.x = point.at("x").number()};
        if (const std::optional<JsonCursor> colour = point.find("color")) {
            if (colour->size() != 3) {
                colour->fail("must be red, green, blue");
            }
            for (int c = 0; c < 3; ++c) {
                node.value[c] = colour->at(static_cast<std::size_t>(c)).number();
            }
        } else {
            node.value = glm::dvec3(point.at("y").number());
        }
        if (const std::optional<JsonCursor> midpoint = point.find("midpoint")) {
            node.midpoint = midpoint->number(0.0, 1.0);
        }
        if (const std::optional<JsonCursor> sharpness = point.find("sharpness")) {
            node.sharpness = sharpness->number(0.0, 1.0);
        }
        nodes.push_back(node);
    }
    return nodes;
}

void read_number(const JsonCursor& object, const char* key, double& value) {
    if (const std::optional<JsonCursor> found = object.find(key)) {
        value = found->number();
    }
}

std::vector<CurveKnot> colour_of(const JsonCursor& component) {
    for (const char* key : {"rgbTransferFunction", "grayTransferFunction"}) {
        if (const std::optional<JsonCursor> function = component.find(key)) {
            std::vector<VtkNode> nodes = json_nodes(*function);
            if (!nodes.empty()) {
                return straighten(std::move(nodes));
            }
        }
    }
    return {{0.0, glm::dvec3(1.0)}};
}

void read_component(const JsonCursor& component, TransferFunction& function) {
    // The schema's own defaults.
    function.lighting = {.ambient = 0.1, .diffuse = 0.7, .specular = 0.2, .shininess = 10.0};
    if (const std::optional<JsonCursor> shade = component.find("shade")) {
        function.shaded = shade->boolean();
    }
    if (const std::optional<JsonCursor> lighting = component.find("lighting")) {
        read_number(*lighting, "ambient", function.lighting.ambient);
        read_number(*lighting, "diffuse", function.lighting.diffuse);
        read_number(*lighting, "specular", function.lighting.specular);
        read_number(*lighting, "specularPower", function.lighting.shininess);
    }
    if (const std::optional<JsonCursor> unit = component.find("scalarOpacityUnitDistance")) {
        function.reference_length_mm = unit->number();
        if (!(function.reference_length_mm > 0.0)) {
            unit->fail("must be above 0");
        }
    }
    const JsonCursor opacity = component.at("scalarOpacity");
    std::vector<VtkNode> nodes = json_nodes(opacity);
    if (nodes.empty()) {
        opacity.at("points").fail("has no points");
    }
    function.points = merge(colour_of(component), straighten(std::move(nodes)));
    const std::optional<JsonCursor> off = component.find("disableGradientOpacity");
    const std::optional<JsonCursor> gradient = component.find("gradientOpacity");
    if (gradient && !(off && off->boolean())) {
        function.gradient = gradient_axis(json_nodes(*gradient));
    }
}

}  // namespace

std::vector<GradientPoint> gradient_axis(std::vector<VtkNode> nodes) {
    std::vector<GradientPoint> axis;
    for (const CurveKnot& knot : straighten(std::move(nodes))) {
        axis.push_back({knot.x, knot.value.x});
    }
    if (std::ranges::all_of(axis, [](const GradientPoint& p) { return p.factor == 1.0; })) {
        axis.clear();
    }
    return axis;
}

TransferFunction read_slicer_text(const std::filesystem::path& file, std::string_view text) {
    VpLines lines(file, text);
    TransferFunction function;
    const double interpolation = lines.number("interpolation");
    if (interpolation != 0.0 && interpolation != 1.0 && interpolation != 2.0) {
        lines.fail("interpolation",
                   "must be 0 (nearest), 1 (linear) or 2 (cubic), is " + number_text(interpolation));
    }
    function.nearest = interpolation == 0.0;
    const double shade = lines.number("shade");
    if (shade != 0.0 && shade != 1.0) {
        lines.fail("shade", "must be 0 or 1, is " + number_text(shade));
    }
    function.shaded = shade == 1.0;
    function.lighting.diffuse = lines.number("diffuse");
    function.lighting.ambient = lines.number("ambient");
    function.lighting.specular = lines.number("specular");
    function.lighting.shininess = lines.number("specular power");
    const std::vector<double> opacity = lines.numbers("scalar opacity", 2);
    if (opacity.empty()) {
        lines.fail("scalar opacity", "has no points");
    }
    function.gradient = gradient_axis(nodes_of(lines.numbers("gradient opacity", 2)));
    const std::vector<double> colour = lines.numbers("colour", 4);
    if (colour.empty()) {
        lines.fail("colour", "has no points");
    }
    std::vector<VtkNode> colours;
    for (std::size_t i = 0; i < colour.size(); i += 4) {
        colours.push_back({.x = colour[i], .value = {colour[i + 1], colour[i + 2], colour[i + 3]}});
    }
    function.points = merge(straighten(std::move(colours)), straighten(nodes_of(opacity)));
    return function;
}

std::vector<TransferFunction> read_slicer_json(const JsonCursor& root, Log& log) {
    const JsonCursor properties = root.at("volumeProperties");
    std::vector<TransferFunction> functions;
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const JsonCursor property = properties.at(i);
        TransferFunction& function = functions.emplace_back();
        if (const std::optional<JsonCursor> name = property.find("name")) {
            function.name = name->text();
        }
        if (const std::optional<JsonCursor> kind = property.find("interpolationType")) {
            const std::string text = kind->text();
            if (text != "nearest" && text != "linear" && text != "cubic") {
                kind->fail("must be nearest, linear or cubic, is " + quote(text));
            }
            function.nearest = text == "nearest";
        }
        const JsonCursor components = property.at("components");
        if (components.size() == 0) {
            components.fail("has no components");
        }
        if (components.size() > 1) {
            log.fault("transfer function: components left out",
                      root.file().string() + ": " + components.pointer() + ": only the first of " +
                          std::to_string(components.size()) + " components is taken",
                      components.size() - 1);
        }
        read_component(components.at(0), function);
    }
    if (functions.empty()) {
        properties.fail("is empty");
    }
    return functions;
}

}  // namespace viscera::io
