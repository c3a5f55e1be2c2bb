#include "tests/embed/embed_test.h"

#include <algorithm>

#include "engine/gl/pixel_transfer.h"

namespace viscera::test {

EmbedTest::EmbedTest()
    : context_(GetParam()), gl_(gl::Functions::load(context_.proc())), registry_(all_effects()) {
    host_.emplace(gl());
    poison_.emplace(gl());
    gl().BindFramebuffer(GL_FRAMEBUFFER, host_->objects().framebuffer);
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
}

void EmbedTest::TearDown() {
    unpoison();
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
    poison_.reset();
    host_.reset();
}

RendererOptions EmbedTest::options() {
    return {.log = [this](LogLevel level, std::string_view message) {
        if (level == LogLevel::warning || level == LogLevel::error) {
            complaints_.emplace_back(message);
        }
    }};
}

void EmbedTest::poison() {
    before_poison_.emplace(saved());
    for (const gl::HostState::Entry& entry : before_poison_->entries()) {
        entry.row->poison(gl(), poison_->objects());
    }
    ASSERT_EQ(changed_rows(*before_poison_, saved()).size(), before_poison_->entries().size())
        << "a row is not poisoned";
}

void EmbedTest::unpoison() {
    if (before_poison_) {
        before_poison_->restore();
        before_poison_.reset();
    }
}

gl::HostState EmbedTest::saved() {
    gl::HostState state(gl());
    state.save(log_);
    return state;
}

std::vector<std::string> EmbedTest::changed_rows(const gl::HostState& a, const gl::HostState& b) {
    std::vector<std::string> names;
    for (const gl::HostState::Entry& entry : a.entries()) {
        if (!std::ranges::equal(a.values(entry), b.values(entry))) {
            names.emplace_back(entry.row->name);
        }
    }
    return names;
}

std::map<std::string, Image> EmbedTest::clean_pictures(const Scene& scene, const HostValues* values,
                                                       double time_s) {
    context_.release();
    std::map<std::string, Image> images;
    {
        const HostContext other(GetParam());
        Renderer renderer(other.proc(), registry_);
        renderer.set_scene(scene);
        Frame frame = renderer.still(time_s);
        frame.values = values;
        renderer.render(frame);
        images = pictures(renderer);
    }
    context_.make_current();
    return images;
}

HostCanvas::HostCanvas(const gl::Functions& gl, int width, int height, PixelFormat format)
    : texture(gl::Texture::make_2d(gl, width, height, format, "canvas")), framebuffer(gl, texture, "canvas") {
    framebuffer.bind();
    framebuffer.clear_colour(0, colour);
}

Image HostCanvas::read(const gl::Functions& gl) const {
    return gl::read_texture(gl, texture);
}

}  // namespace viscera::test
