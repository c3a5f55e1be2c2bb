#include "effects/tissue/blood_seams.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <vector>

namespace viscera::tissue {
namespace {

constexpr std::size_t row = 1024;      // of a list
constexpr std::size_t chunk_side = 4;  // as blood_seam.vert
constexpr std::size_t chunks_in_row = row / chunk_side;

/// A cell at seams.
struct Cell {
    std::size_t block = 0;
    std::size_t parts = 0;
    std::size_t index = 0;
};

/// By blocks, and within one those with as many parts together: a group of fragments takes as long as the
/// longest. `side`: of blocks [texels].
std::vector<Cell> cells_in_order(std::span<const float> first_of_cell, std::span<const SeamLink> parts,
                                 std::size_t size, std::size_t side) {
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < first_of_cell.size(); ++i) {
        if (first_of_cell[i] >= 0.0F) {
            const auto first = static_cast<std::size_t>(first_of_cell[i]);
            std::size_t last = first;
            while (parts[last].side < 4.0F) {
                ++last;
            }
            cells.push_back({(i / size / side) * size + i % size / side, last - first, i});
        }
    }
    std::ranges::sort(cells, {},
                      [](const Cell& cell) { return std::tuple(cell.block, cell.parts, cell.index); });
    return cells;
}

/// Place in a list of the n-th cell of a chunk, which is a square of it.
std::size_t place_in_chunk(std::size_t chunk, std::size_t n) {
    const std::size_t x = chunk % chunks_in_row * chunk_side + n % chunk_side;
    const std::size_t y = chunk / chunks_in_row * chunk_side + n / chunk_side;
    return y * row + x;
}

}  // namespace

BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size, int block_side) {
    const auto width = static_cast<std::size_t>(size);
    std::vector<float> place_of_cell(width * width);
    const std::vector<SeamLink> parts = links_by_cell(links, place_of_cell);
    std::vector<glm::vec4> part_items;
    std::ranges::transform(parts, std::back_inserter(part_items), [](const SeamLink& link) {
        return glm::vec4(link.from, link.to, link.side, link.share);
    });
    const std::vector<Cell> order =
        cells_in_order(place_of_cell, parts, width, static_cast<std::size_t>(block_side));
    std::vector<glm::vec4> cells;
    std::size_t chunks = 0;
    std::size_t in_chunk = 0;
    for (std::size_t n = 0; n < order.size(); ++n) {
        const bool begins =
            n == 0 || order[n].block != order[n - 1].block || in_chunk == chunk_side * chunk_side;
        chunks += begins ? 1 : 0;
        in_chunk = begins ? 0 : in_chunk;
        const std::size_t place = place_in_chunk(chunks - 1, in_chunk++);
        cells.resize(std::max(cells.size(), (place / (row * chunk_side) + 1) * row * chunk_side),
                     glm::vec4(0.0F));
        const std::size_t cell = order[n].index;
        cells[place] = {cell % width, cell / width, place_of_cell[cell], 1.0F};
        place_of_cell[cell] = static_cast<float>(place);
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
            std::move(pulls_target), std::move(came),      std::move(came_target), static_cast<int>(chunks)};
}

}  // namespace viscera::tissue
