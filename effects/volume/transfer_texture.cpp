#include "effects/volume/transfer_texture.h"

#include "engine/core/hash.h"

namespace viscera::volume {

std::uint64_t TransferTexture::key_of(std::uint64_t parameters_key, const Source& source) {
    return Hash().add(parameters_key).add(source.state_key()).value();
}

void TransferTexture::make(const gl::Functions& gl, const ClassificationTable& table,
                           std::uint64_t parameters_key, const Source& source) {
    table_.emplace(Table{gl::Texture::from_row(gl, std::as_bytes(std::span(table.entries)),
                                               gl::texture_format(PixelFormat::rgba32f), "transfer function"),
                         table.place,
                         shown_ == EntriesShown::all ? 0.0F : static_cast<float>(table.first_seen()) - 1.0F});
    key_ = key_of(parameters_key, source);
}

void TransferTexture::bind(const Pass& pass, const gl::Program& program) const {
    pass.bind(program, "u_transfer", table_->entries, gl::Filter::nearest);
    program.set("u_transfer_place", glm::vec3(table_->place, table_->entries.width() - 1));
    program.set("u_transfer_seen", table_->seen);
}

}  // namespace viscera::volume
