#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/size_text.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

struct Point {
    std::array<double, 3> place{};
    double value = 0.0;
    std::size_t line = 0;
};

std::optional<Point> parse(std::string_view line, std::size_t number) {
    std::array<double, 4> values{};
    for (std::size_t column = 0; column < 4; ++column) {
        const std::size_t end = column < 3 ? line.find_first_of(",;") : line.size();
        if (end == std::string_view::npos) {
            return std::nullopt;
        }
        const std::optional<double> value = to_number(trim(line.substr(0, end)));
        if (!value) {
            return std::nullopt;
        }
        values.at(column) = *value;
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return Point{{values[0], values[1], values[2]}, values[3], number};
}

std::vector<Point> read_points(const Reading& reading) {
    const std::string text = read_file(reading.file);
    std::vector<Point> points;
    std::size_t number = 0;
    for (std::string_view rest = text; !rest.empty();) {
        const std::string_view line = trim(take_line(rest));
        ++number;
        if (line.empty() || line.starts_with('#')) {
            continue;
        }
        const std::optional<Point> point = parse(line, number);
        const bool is_title = number == 1 && !point;
        if (is_title) {
            continue;
        }
        if (!point) {
            reading.fail("line " + std::to_string(number) + ": '" + printable(line) + "' is not x,y,z,value");
        }
        for (const double coordinate : point->place) {
            if (!std::isfinite(coordinate)) {
                reading.fail("line " + std::to_string(number) + ": a coordinate is not finite");
            }
        }
        points.push_back(*point);
    }
    if (points.empty()) {
        reading.fail("holds no points");
    }
    return points;
}

/// One axis of the grid that the points lie on.
struct Axis {
    double first = 0.0;
    double spacing = 1.0;
    std::size_t count = 1;

    [[nodiscard]] double index_of(double coordinate) const { return (coordinate - first) / spacing; }
};

/// The spacing is the smallest step between two coordinates; steps of rounding are none.
Axis find_axis(const std::vector<Point>& points, std::size_t axis, const Reading& reading) {
    std::vector<double> places(points.size());
    std::ranges::transform(points, places.begin(), [&](const Point& p) { return p.place.at(axis); });
    std::ranges::sort(places);
    const double extent = places.back() - places.front();
    const double rounding =
        1e-9 * std::max(std::abs(places.front()), std::abs(places.back())) + 1e-7 * extent;
    double spacing = extent;
    for (std::size_t i = 1; i < places.size(); ++i) {
        if (const double step = places[i] - places[i - 1]; step > rounding) {
            spacing = std::min(spacing, step);
        }
    }
    if (!(extent > 0.0)) {
        return {places.front(), 1.0, 1};
    }
    const double steps = std::round(extent / spacing);
    if (!(steps < static_cast<double>(points.size()))) {
        reading.fail(std::string("column ") + "xyz"[axis] + ": its places are not evenly spaced");
    }
    return {places.front(), extent / steps, static_cast<std::size_t>(steps) + 1};
}

}  // namespace

Volume read_csv_volume(const Reading& reading) {
    const std::vector<Point> points = read_points(reading);
    std::array<Axis, 3> axes{};
    VolumeHead head;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        axes.at(axis) = find_axis(points, axis, reading);
        const auto a = static_cast<int>(axis);
        head.volume.grid.dims[a] = static_cast<int>(axes.at(axis).count);
        head.volume.grid.spacing_mm[a] = axes.at(axis).spacing;
        head.volume.grid.origin_mm[a] = axes.at(axis).first;
    }
    head.type = FileScalar::f64;
    const std::uint64_t due = head.bytes(reading);
    const std::string size = size_text(head.volume.grid.dims);
    // Twice the points would be half a grid: more likely no grid at all.
    if (due / sizeof(double) > 2 * points.size()) {
        reading.fail(std::to_string(points.size()) + " points are no grid of " + size);
    }
    require_memory(head, due, reading);
    std::vector<double> values(due / sizeof(double), 0.0);
    std::vector<std::size_t> lines(values.size(), 0);
    for (const Point& point : points) {
        std::array<std::size_t, 3> index{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double exact = axes.at(axis).index_of(point.place.at(axis));
            constexpr double off_grid = 0.05;
            if (std::abs(exact - std::round(exact)) > off_grid) {
                reading.fail("line " + std::to_string(point.line) + ": column " + "xyz"[axis] +
                             " is off the grid of " + size + " points");
            }
            index.at(axis) = static_cast<std::size_t>(std::round(exact));
        }
        const std::size_t place = index[0] + axes[0].count * (index[1] + axes[1].count * index[2]);
        if (lines[place] != 0) {
            reading.fail("line " + std::to_string(point.line) + " gives a place that line " +
                         std::to_string(lines[place]) + " gave");
        }
        lines[place] = point.line;
        values[place] = point.value;
    }
    if (const auto missing = std::ranges::find(lines, 0U); missing != lines.end()) {
        const auto place = static_cast<std::size_t>(missing - lines.begin());
        std::string at;
        std::size_t rest = place;
        for (const Axis& axis : axes) {
            at += " " + std::to_string(axis.first + axis.spacing * static_cast<double>(rest % axis.count));
            rest /= axis.count;
        }
        reading.fail("the point at" + at + " is missing from the grid of " + size);
    }
    return read_voxels(head, read_from_memory(std::as_bytes(std::span(values)), reading), reading);
}

}  // namespace viscera::io
