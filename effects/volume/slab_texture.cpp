#include "effects/volume/slab_texture.h"

#include <algorithm>
#include <vector>

namespace viscera::volume {
namespace {

constexpr gl::TextureFormat bin_format{GL_RG16UI, GL_RG_INTEGER, GL_UNSIGNED_SHORT, 4};

}  // namespace

SlabTexture::SlabTexture(const gl::Functions& gl, std::span<const SlabTable> tables)
    : pieces_(gl::Texture::make_2d(gl, std::ranges::max(tables, {}, &SlabTable::pieces).pieces,
                                   SlabTable::rows * static_cast<int>(tables.size()), PixelFormat::rgba32f,
                                   "pieces of slabs")),
      bins_(gl::Texture::make_2d(gl, static_cast<int>(tables.front().bins.size()),
                                 static_cast<int>(tables.size()), bin_format, "bins of slabs")),
      bin_(tables.front().bin) {
    const auto width = static_cast<std::size_t>(std::ranges::max(tables, {}, &SlabTable::pieces).pieces);
    std::vector<glm::vec4> texels;
    std::vector<SlabTable::Bin> bins;
    for (const SlabTable& table : tables) {
        const auto pieces = static_cast<std::size_t>(table.pieces);
        for (std::size_t row = 0; row < SlabTable::rows; ++row) {
            const auto first = table.texels.begin() + static_cast<std::ptrdiff_t>(row * pieces);
            texels.insert(texels.end(), first, first + table.pieces);
            // The shader takes the last column for the last piece.
            texels.resize(texels.size() + width - pieces, table.texels[(row + 1) * pieces - 1]);
        }
        bins.insert(bins.end(), table.bins.begin(), table.bins.end());
    }
    pieces_.upload(std::as_bytes(std::span(texels)));
    bins_.upload(std::as_bytes(std::span(bins)));
}

void SlabTexture::bind(const Pass& pass, const gl::Program& program) const {
    pass.bind(program, "u_pieces", pieces_, gl::Filter::nearest);
    pass.bind(program, "u_piece_bins", bins_, gl::Filter::nearest);
    program.set("u_piece_bin", bin_);
}

}  // namespace viscera::volume
