#include "effects/tissue/blood_seams.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <vector>

namespace viscera::tissue {
namespace {

constexpr std::size_t region_side = 32;  // [texels]
constexpr std::size_t row = 1024;        // of a list

/// Cells at seams in the order in which they are computed: those of one region together, which are stepped
/// or not, and of these those with as many parts, since a group of fragments takes as long as the longest.
std::vector<std::size_t> cells_in_order(std::span<const float> first_of_cell, std::span<const SeamLink> parts,
                                        std::size_t size) {
    struct Cell {
        std::size_t region = 0;
        std::size_t parts = 0;
        std::size_t index = 0;
    };
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < first_of_cell.size(); ++i) {
        if (first_of_cell[i] >= 0.0F) {
            const auto first = static_cast<std::size_t>(first_of_cell[i]);
            std::size_t last = first;
            while (parts[last].side < 4.0F) {
                ++last;
            }
            cells.push_back({(i / size / region_side) * size + i % size / region_side, last - first, i});
        }
    }
    std::ranges::sort(cells, {},
                      [](const Cell& cell) { return std::tuple(cell.region, cell.parts, cell.index); });
    std::vector<std::size_t> order(cells.size());
    std::ranges::transform(cells, order.begin(), &Cell::index);
    return order;
}

/// Place in a list of the n-th fragment: software renderers compute 4 x 2 of them at once.
std::size_t place_of(std::size_t n) {
    const std::size_t in_rows = n % (2 * row);
    return (n / (2 * row) * 2 + (n % 8) / 4) * row + in_rows / 8 * 4 + n % 4;
}

}  // namespace

BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size) {
    const auto width = static_cast<std::size_t>(size);
    std::vector<float> place_of_cell(width * width);
    const std::vector<SeamLink> parts = links_by_cell(links, place_of_cell);
    std::vector<glm::vec4> part_items;
    std::ranges::transform(parts, std::back_inserter(part_items), [](const SeamLink& link) {
        return glm::vec4(link.from, link.to, link.side, link.share);
    });
    const std::vector<std::size_t> order = cells_in_order(place_of_cell, parts, width);
    std::vector<glm::vec4> cells((order.size() + 2 * row - 1) / (2 * row) * (2 * row), glm::vec4(0.0F));
    for (std::size_t n = 0; n < order.size(); ++n) {
        const std::size_t cell = order[n];
        cells[place_of(n)] = {cell % width, cell / width, place_of_cell[cell], 1.0F};
        place_of_cell[cell] = static_cast<float>(place_of(n));
    }
    gl::Texture places = gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "cells at seams");
    places.upload(std::as_bytes(std::span(place_of_cell)));
    ListTexture cell_list;
    cell_list.upload(gl, cells, "cells at seams");
    ListTexture link_list;
    link_list.upload(gl, part_items, "parts of seams");
    gl::Texture pulls = gl::Texture::make_2d(gl, link_list.texture().width(), link_list.rows(),
                                             PixelFormat::rgba32f, "fall across seams");
    gl::Texture came = gl::Texture::make_2d(gl, cell_list.texture().width(), cell_list.rows(),
                                            PixelFormat::r32f, "what comes across seams");
    gl::Framebuffer pulls_target(gl, pulls, "fall across seams");
    gl::Framebuffer came_target(gl, came, "what comes across seams");
    return {std::move(places),       std::move(cell_list), std::move(link_list),   std::move(pulls),
            std::move(pulls_target), std::move(came),      std::move(came_target), links.empty()};
}

}  // namespace viscera::tissue
