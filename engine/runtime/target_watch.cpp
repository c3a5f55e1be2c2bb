#include "engine/runtime/target_watch.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "engine/core/error.h"
#include "engine/gl/format.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/raster_state.h"
#include "engine/runtime/capture.h"
#include "engine/runtime/executor.h"

namespace viscera {
namespace {

// Requests of one target under way, or 1 where they share a mirror. A GPU that is farther behind is asked
// again when it has caught up, for all that has changed by then.
constexpr std::size_t most_requests = 4;

/// Versions are unlike over all copies, so that one who is given another scene's or renderer's notices.
std::uint64_t next_version() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

std::size_t region_bytes(const PixelRegion& region, PixelFormat format) {
    return static_cast<std::size_t>(region.area()) * bytes_per_pixel(format);
}

/// Puts tightly packed rows into their place in a picture.
void place_rows(Image& image, const PixelRect& rect, const std::byte* rows) {
    const std::size_t pixel = bytes_per_pixel(image.format);
    const std::size_t row = static_cast<std::size_t>(rect.width) * pixel;
    for (int y = 0; y < rect.height; ++y) {
        const std::size_t at = (static_cast<std::size_t>(rect.y + y) * static_cast<std::size_t>(image.width) +
                                static_cast<std::size_t>(rect.x)) *
                               pixel;
        std::memcpy(image.data.data() + at, rows + static_cast<std::size_t>(y) * row, row);
    }
}

}  // namespace

TargetWatch::~TargetWatch() {
    for (const std::unique_ptr<Entry>& entry : entries_) {
        drop(*entry);
    }
}

void TargetWatch::drop(Entry& entry) {
    for (const Request& request : entry.requests) {
        gl_.DeleteSync(request.fence);
    }
    entry.left_out = entry.left_out || !entry.requests.empty();
    entry.requests.clear();
    entry.asked_key = entry.shown_key;
}

void TargetWatch::forget() {
    const std::vector<std::string> names = targets();
    set_targets({});
    set_targets(names);
    free_.clear();  // of the sizes of the scene before
}

void TargetWatch::set_path(WatchPath path) {
    if (path != path_) {
        path_ = path;
        for (const std::unique_ptr<Entry>& entry : entries_) {
            drop(*entry);
        }
    }
}

void TargetWatch::set_targets(const std::vector<std::string>& targets) {
    std::vector<std::unique_ptr<Entry>> kept;
    for (const std::string& target : targets) {
        const auto found = std::ranges::find_if(entries_, [&](const std::unique_ptr<Entry>& entry) {
            return entry != nullptr && entry->shown.target == target;
        });
        if (found != entries_.end()) {
            kept.push_back(std::move(*found));
        } else {
            kept.push_back(std::make_unique<Entry>());
            kept.back()->shown.target = target;
        }
    }
    for (const std::unique_ptr<Entry>& entry : entries_) {
        if (entry != nullptr) {
            drop(*entry);
        }
    }
    entries_ = std::move(kept);
}

std::vector<std::string> TargetWatch::targets() const {
    std::vector<std::string> names;
    for (const std::unique_ptr<Entry>& entry : entries_) {
        names.push_back(entry->shown.target);
    }
    return names;
}

const WatchedTarget* TargetWatch::find(std::string_view target) const {
    const auto found = std::ranges::find_if(
        entries_, [&](const std::unique_ptr<Entry>& entry) { return entry->shown.target == target; });
    return found != entries_.end() && (*found)->any ? &(*found)->shown : nullptr;
}

void TargetWatch::frame_done(Executor& executor, std::uint64_t index, double time_s) {
    take();  // before the mirrors change
    ++frames_;
    index_ = index;
    time_s_ = time_s;
    for (const std::unique_ptr<Entry>& pointer : entries_) {
        Entry& entry = *pointer;
        const std::optional<Executor::Output> output = executor.output(entry.shown.target);
        if (!output) {
            throw Error(ErrorCode::usage, entry.shown.target, "is watched, but no live pass writes it");
        }
        const PlanContent& content = *output->content;
        if (info(content.format).is_depth) {
            throw Error(ErrorCode::usage, entry.shown.target, "holds depth, which cannot be watched");
        }
        const bool same_shape = entry.shown.image.width == content.width &&
                                entry.shown.image.height == content.height &&
                                entry.shown.image.format == content.format;
        if (!same_shape) {
            drop(entry);
            entry.mirror_frame.reset();
            entry.mirror.reset();
            entry.shown.image = make_image(content.width, content.height, content.format);
            entry.any = false;
            entry.shown_key = entry.asked_key = 0;
        }
        entry.left_out = false;
        if (output->key == entry.asked_key) {
            // What is shown, or on its way, is this frame's, too.
            if (!entry.requests.empty()) {
                entry.requests.back().frame_count = frames_;
                entry.requests.back().index = index;
                entry.requests.back().time_s = time_s;
            } else if (entry.any) {
                entry.shown_count = frames_;
                entry.shown.frame = index;
                entry.shown.time_s = time_s;
            }
        } else if (output->texture == nullptr || may_ask(entry)) {
            ask(entry, executor, *output);
        } else {
            entry.left_out = true;
        }
        count_age(entry);
    }
}

bool TargetWatch::may_ask(const Entry& entry) const {
    return entry.requests.size() < (path_ == WatchPath::buffered ? most_requests : 1);
}

/// For all that has changed since what was asked for before.
void TargetWatch::ask(Entry& entry, Executor& executor, const Executor::Output& output) {
    Request request{.key = output.key, .frame_count = frames_, .index = index_, .time_s = time_s_};
    const PlanContent& content = *output.content;
    entry.left_out = false;
    if (output.texture == nullptr) {
        drop(entry);
        entry.left_out = false;
        entry.shown.image = clear_image(content);
        entry.asked_key = output.key;
        show(entry, request);
        return;
    }
    const gl::Framebuffer& source = executor.framebuffer(output);
    const gl::Texture& texture = *output.texture;
    const PixelRegion all(PixelRect{0, 0, content.width, content.height});
    request.region = executor.changed(entry.asked_key, output.key).value_or(all);
    entry.requests.reserve(most_requests);
    if (path_ == WatchPath::buffered) {
        request.buffer.emplace(take_buffer(region_bytes(request.region, entry.shown.image.format)));
        gl::set_tight_packing(gl_);
        source.bind();
        request.buffer->bind(GL_PIXEL_PACK_BUFFER);
        std::size_t offset = 0;
        for (const PixelRect& rect : request.region.rects()) {
            gl_.ReadPixels(rect.x, rect.y, rect.width, rect.height, texture.format().external,
                           texture.format().type, reinterpret_cast<void*>(offset));
            offset += static_cast<std::size_t>(rect.area()) * texture.format().bytes_per_pixel;
        }
        gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    } else {
        copy_to_mirror(entry, source, texture, request.region);
    }
    request.fence = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl_.Flush();  // else one who only polls may never see the fence reached
    entry.asked_key = request.key;
    entry.requests.push_back(std::move(request));
}

/// The smallest that is large enough. Where none is, a new one takes the place of one that is too small, so
/// that there are never more than were under way at once.
gl::Buffer TargetWatch::take_buffer(std::size_t bytes) {
    std::ranges::sort(free_, {}, &gl::Buffer::bytes);
    const auto fits = std::ranges::lower_bound(free_, bytes, {}, &gl::Buffer::bytes);
    if (fits != free_.end()) {
        gl::Buffer buffer = std::move(*fits);
        free_.erase(fits);
        return buffer;
    }
    if (!free_.empty()) {
        free_.pop_back();
    }
    return {gl_, std::max<std::size_t>(bytes, 1), gl::BufferUsage::read_back};
}

void TargetWatch::copy_to_mirror(Entry& entry, const gl::Framebuffer& source, const gl::Texture& texture,
                                 const PixelRegion& region) {
    if (!entry.mirror) {
        entry.mirror = std::make_unique<gl::Texture>(gl::Texture::make_2d(
            gl_, texture.width(), texture.height(), texture.format(), "mirror of " + entry.shown.target));
        entry.mirror_frame = std::make_unique<gl::Framebuffer>(gl_, *entry.mirror, "mirror");
    }
    gl::apply(gl_, gl::overwrite_state, {0, 0, texture.width(), texture.height()});
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, source.id());
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, entry.mirror_frame->id());
    for (const PixelRect& rect : region.rects()) {
        const int right = rect.x + rect.width;
        const int top = rect.y + rect.height;
        gl_.BlitFramebuffer(rect.x, rect.y, right, top, rect.x, rect.y, right, top, GL_COLOR_BUFFER_BIT,
                            GL_NEAREST);
    }
}

void TargetWatch::take() {
    for (const std::unique_ptr<Entry>& entry : entries_) {
        take_arrived(*entry);
    }
}

void TargetWatch::poll(Executor& executor) {
    for (const std::unique_ptr<Entry>& entry : entries_) {
        take_arrived(*entry);
        ask_for_left_out(*entry, executor);
    }
}

void TargetWatch::wait(Executor& executor, std::uint64_t most_frames_behind) {
    constexpr GLuint64 second = 1'000'000'000;
    poll(executor);
    for (const std::unique_ptr<Entry>& entry : entries_) {
        while (!entry->requests.empty() && (!entry->any || entry->shown.frames_behind > most_frames_behind)) {
            const GLenum reached = gl_.ClientWaitSync(entry->requests.front().fence, 0, second);
            if (reached == GL_WAIT_FAILED) {
                throw Error(ErrorCode::gl, entry->shown.target, "waiting for it failed");
            }
            if (reached != GL_TIMEOUT_EXPIRED) {
                take_first(*entry);
                ask_for_left_out(*entry, executor);
            }
        }
    }
}

void TargetWatch::ask_for_left_out(Entry& entry, Executor& executor) {
    if (!entry.left_out || !may_ask(entry)) {
        return;
    }
    // None: what the last frame made has been given away, or lies with a plan that is gone.
    const std::optional<Executor::Output> output = executor.output(entry.shown.target);
    if (output && !output->imported) {
        ask(entry, executor, *output);
        count_age(entry);
    }
}

void TargetWatch::take_arrived(Entry& entry) {
    while (!entry.requests.empty() &&
           gl_.ClientWaitSync(entry.requests.front().fence, 0, 0) != GL_TIMEOUT_EXPIRED) {
        take_first(entry);
    }
    count_age(entry);
}

void TargetWatch::take_first(Entry& entry) {
    Request request = std::move(entry.requests.front());
    entry.requests.erase(entry.requests.begin());
    gl_.DeleteSync(request.fence);
    try {
        arrive(entry, request);
    } catch (...) {
        // A part is missing, on which those that follow build: all of it is asked for anew.
        entry.any = false;
        entry.shown_key = 0;
        entry.left_out = true;
        drop(entry);
        throw;
    }
    count_age(entry);
}

void TargetWatch::arrive(Entry& entry, Request& request) {
    Image& image = entry.shown.image;
    const std::size_t pixel = bytes_per_pixel(image.format);
    if (request.buffer) {
        request.buffer->bind(GL_COPY_WRITE_BUFFER);
        const auto bytes = static_cast<GLsizeiptr>(region_bytes(request.region, image.format));
        const auto* mapped = bytes == 0 ? nullptr
                                        : static_cast<const std::byte*>(gl_.MapBufferRange(
                                              GL_COPY_WRITE_BUFFER, 0, bytes, GL_MAP_READ_BIT));
        if (bytes != 0 && mapped == nullptr) {
            throw Error(ErrorCode::gl, entry.shown.target, "the driver gave no access to the pixels");
        }
        for (const PixelRect& rect : request.region.rects()) {
            place_rows(image, rect, mapped);
            mapped += static_cast<std::size_t>(rect.area()) * pixel;
        }
        if (bytes != 0 && gl_.UnmapBuffer(GL_COPY_WRITE_BUFFER) == GL_FALSE) {
            throw Error(ErrorCode::gl, entry.shown.target, "the driver lost the pixels");
        }
        free_.push_back(*std::move(request.buffer));
    } else {
        // Straight into the picture: all that it waits for has been done.
        entry.mirror_frame->bind();
        gl::set_tight_packing(gl_);
        gl_.PixelStorei(GL_PACK_ROW_LENGTH, image.width);
        const gl::TextureFormat format = gl::texture_format(image.format);
        for (const PixelRect& rect : request.region.rects()) {
            const std::size_t at = (static_cast<std::size_t>(rect.y) * static_cast<std::size_t>(image.width) +
                                    static_cast<std::size_t>(rect.x)) *
                                   pixel;
            gl_.ReadPixels(rect.x, rect.y, rect.width, rect.height, format.external, format.type,
                           image.data.data() + at);
        }
        gl_.PixelStorei(GL_PACK_ROW_LENGTH, 0);
    }
    show(entry, request);
}

void TargetWatch::show(Entry& entry, const Request& request) {
    entry.any = true;
    entry.shown_key = request.key;
    entry.shown_count = request.frame_count;
    entry.shown.frame = request.index;
    entry.shown.time_s = request.time_s;
    entry.shown.version = next_version();
}

}  // namespace viscera
