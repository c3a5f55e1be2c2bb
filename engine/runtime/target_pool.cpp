#include "engine/runtime/target_pool.h"

#include <algorithm>
#include <string>
#include <utility>

namespace viscera {
namespace {

gl::Texture make(const gl::Functions& gl, const PlanTexture& texture, std::size_t index) {
    return gl::Texture::make_2d(gl, texture.width, texture.height, texture.format,
                                "target texture " + std::to_string(index));
}

}  // namespace

void TargetPool::reset(const Plan& plan) {
    framebuffers_.clear();
    std::vector<PlanTexture> old = std::exchange(descriptions_, {});
    std::vector<gl::Texture> old_textures = std::exchange(textures_, {});
    keys_.clear();
    for (const PlanTexture& wanted : plan.textures) {
        const auto fits = std::ranges::find_if(old, [&](const PlanTexture& t) {
            return t.format == wanted.format && t.width == wanted.width && t.height == wanted.height;
        });
        if (fits != old.end()) {
            const auto index = fits - old.begin();
            textures_.push_back(std::move(old_textures[static_cast<std::size_t>(index)]));
            old.erase(fits);
            old_textures.erase(old_textures.begin() + index);
        } else {
            textures_.push_back(make(gl_, wanted, textures_.size()));
        }
        descriptions_.push_back(wanted);
    }
    keys_.resize(textures_.size());
    backdrops_.resize(textures_.size());
    forget_content();
}

void TargetPool::forget_content() {
    std::ranges::fill(keys_, 0);
    std::ranges::fill(backdrops_, Backdrop{});
}

GLuint TargetPool::release(GLuint id) {
    const auto found = std::ranges::find(textures_, id, &gl::Texture::id);
    if (found == textures_.end()) {
        return 0;
    }
    const auto index = static_cast<std::size_t>(found - textures_.begin());
    framebuffers_.clear();
    (void)textures_[index].release();
    textures_[index] = make(gl_, descriptions_[index], index);
    keys_[index] = 0;
    backdrops_[index] = {};
    return id;
}

void TargetPool::swap(std::size_t a, std::size_t b) {
    std::swap(textures_[a], textures_[b]);
    std::swap(keys_[a], keys_[b]);
    std::swap(backdrops_[a], backdrops_[b]);
}

const gl::Framebuffer& TargetPool::framebuffer(std::span<const gl::Texture* const> colours,
                                               const gl::Texture* depth, std::string_view label) {
    Ids ids{};
    for (std::size_t i = 0; i < colours.size(); ++i) {
        ids[i] = colours[i] == nullptr ? 0 : colours[i]->id();
    }
    ids.back() = depth == nullptr ? 0 : depth->id();
    const auto found = std::ranges::find(framebuffers_, ids, &Entry::ids);
    if (found != framebuffers_.end()) {
        return *found->framebuffer;
    }
    framebuffers_.push_back({ids, std::make_unique<gl::Framebuffer>(gl_, colours, depth, label)});
    return *framebuffers_.back().framebuffer;
}

void TargetPool::forget_framebuffers(GLuint texture) {
    std::erase_if(framebuffers_, [&](const Entry& entry) {
        return std::ranges::find(entry.ids, texture) != entry.ids.end();
    });
}

}  // namespace viscera
