#include "effects/volume/slab_texture.h"

namespace viscera::volume {
namespace {

constexpr gl::TextureFormat bin_format{GL_RG16UI, GL_RG_INTEGER, GL_UNSIGNED_SHORT, 4};

}  // namespace

SlabTexture::SlabTexture(const gl::Functions& gl, const SlabTable& table)
    : pieces_(
          gl::Texture::make_2d(gl, table.pieces, SlabTable::rows, PixelFormat::rgba32f, "pieces of slabs")),
      bins_(gl::Texture::make_2d(gl, static_cast<int>(table.bins.size()), 1, bin_format, "bins of slabs")),
      bin_(table.bin) {
    pieces_.upload(std::as_bytes(std::span(table.texels)));
    bins_.upload(std::as_bytes(std::span(table.bins)));
}

void SlabTexture::bind(const Pass& pass, const gl::Program& program) const {
    pass.bind(program, "u_pieces", pieces_, gl::Filter::nearest);
    pass.bind(program, "u_piece_bins", bins_, gl::Filter::nearest);
    program.set("u_piece_bin", bin_);
}

}  // namespace viscera::volume
