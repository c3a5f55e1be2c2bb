#include "effects/volume/transfer_texture.h"

namespace viscera::volume {

TransferTexture::TransferTexture(const gl::Functions& gl, const ClassificationTable& table,
                                 EntriesShown shown)
    : entries_(gl::Texture::from_row(gl, std::as_bytes(std::span(table.entries)),
                                     gl::texture_format(PixelFormat::rgba32f), "transfer function")),
      place_(table.place),
      seen_(shown == EntriesShown::all ? 0.0F : static_cast<float>(table.first_seen()) - 1.0F) {}

void TransferTexture::bind(const Pass& pass, const gl::Program& program) const {
    pass.bind(program, "u_transfer", entries_, gl::Filter::nearest);
    program.set("u_transfer_place", glm::vec3(place_, entries_.width() - 1));
    program.set("u_transfer_seen", seen_);
}

}  // namespace viscera::volume
