#include "engine/gl/pixel_transfer.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/core/error.h"

namespace viscera::gl {
namespace {

PixelFormat readable_format(const Texture& texture) {
    const std::optional<PixelFormat> format = pixel_format(texture.format());
    if (!format || texture.target() != GL_TEXTURE_2D) {
        throw Error(ErrorCode::usage, "read-back", "only 2-D textures of a target format can be read back");
    }
    return *format;
}

/// To the bound pixel pack buffer, or to `pixels`.
void get_pixels(const Functions& gl, const Texture& texture, void* pixels) {
    texture.bind_for_editing();
    gl.GetTexImage(texture.target(), 0, texture.format().external, texture.format().type, pixels);
}

}  // namespace

std::optional<PixelFormat> pixel_format(const TextureFormat& format) {
    for (const FormatInfo& entry : all_formats()) {
        if (texture_format(entry.format) == format) {
            return entry.format;
        }
    }
    return std::nullopt;
}

Image read_texture(const Functions& gl, const Texture& texture) {
    Image image = make_image(texture.width(), texture.height(), readable_format(texture));
    set_tight_packing(gl);
    // llvmpipe (Mesa 22.3) does not wait for what is still being drawn into a texture when a later draw that
    // is also under way samples it.
    gl.Finish();
    get_pixels(gl, texture, image.data.data());
    return image;
}

ReadBack::~ReadBack() {
    for (const Pending& pending : pending_) {
        gl_->DeleteSync(pending.fence);
    }
}

Buffer ReadBack::take_buffer(std::size_t bytes) {
    const auto found = std::ranges::find(free_, bytes, &Buffer::bytes);
    if (found != free_.end()) {
        Buffer buffer = std::move(*found);
        free_.erase(found);
        return buffer;
    }
    // Sizes no longer asked for, as after a resize, must not pile up.
    if (free_.size() > 32) {
        free_.erase(free_.begin());
    }
    return {*gl_, bytes, BufferUsage::read_back};
}

void ReadBack::start(const Texture& texture, std::uint64_t tag) {
    Pending pending{take_buffer(texture.bytes()), nullptr, texture.width(), texture.height(),
                    readable_format(texture),     tag};
    set_tight_packing(*gl_);
    pending.buffer.bind(GL_PIXEL_PACK_BUFFER);
    get_pixels(*gl_, texture, nullptr);
    gl_->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    pending.fence = gl_->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    // Without this the fence may never be reached by one who only polls.
    gl_->Flush();
    pending_.push_back(std::move(pending));
}

std::optional<ReadBack::Result> ReadBack::poll() {
    Result result;
    return poll(result) ? std::optional(std::move(result)) : std::nullopt;
}

bool ReadBack::poll(Result& result) {
    if (pending_.empty() || gl_->ClientWaitSync(pending_.front().fence, 0, 0) == GL_TIMEOUT_EXPIRED) {
        return false;
    }
    finish(result);
    return true;
}

std::optional<ReadBack::Result> ReadBack::wait() {
    if (pending_.empty()) {
        return std::nullopt;
    }
    Result result;
    finish(result);  // mapping waits
    return result;
}

void ReadBack::finish(Result& result) {
    Pending pending = std::move(pending_.front());
    pending_.erase(pending_.begin());
    gl_->DeleteSync(pending.fence);
    result.tag = pending.tag;
    Image& image = result.image;
    if (image.width != pending.width || image.height != pending.height || image.format != pending.format) {
        image = make_image(pending.width, pending.height, pending.format);
    }
    pending.buffer.bind(GL_COPY_WRITE_BUFFER);
    const void* mapped = gl_->MapBufferRange(
        GL_COPY_WRITE_BUFFER, 0, static_cast<GLsizeiptr>(pending.buffer.bytes()), GL_MAP_READ_BIT);
    if (mapped == nullptr) {
        throw Error(ErrorCode::gl, "read-back", "the driver gave no access to the pixels");
    }
    std::memcpy(result.image.data.data(), mapped, result.image.data.size());
    if (gl_->UnmapBuffer(GL_COPY_WRITE_BUFFER) == GL_FALSE) {
        throw Error(ErrorCode::gl, "read-back", "the driver lost the pixels");
    }
    free_.push_back(std::move(pending.buffer));
}

}  // namespace viscera::gl
