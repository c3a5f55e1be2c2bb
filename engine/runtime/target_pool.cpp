#include "engine/runtime/target_pool.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace viscera {
namespace {

gl::Texture make(const gl::Functions& gl, const PlanTexture& texture, std::size_t index) {
    return gl::Texture::make_2d(gl, texture.width, texture.height, texture.format,
                                "target texture " + std::to_string(index));
}

}  // namespace

void TargetPool::reset(const Plan& plan, std::span<const Kept> kept) {
    framebuffers_.clear();
    const std::vector<PlanTexture> old = std::exchange(descriptions_, {});
    std::vector<std::optional<gl::Texture>> old_textures;
    for (gl::Texture& texture : textures_) {
        old_textures.emplace_back(std::move(texture));
    }
    textures_.clear();
    const std::vector<std::uint64_t> old_keys = std::exchange(keys_, {});
    backdrops_.assign(plan.textures.size(), {});
    keys_.assign(plan.textures.size(), 0);
    const auto fits = [&](std::size_t index, const PlanTexture& wanted) {
        return old_textures[index] && old[index].format == wanted.format &&
               old[index].width == wanted.width && old[index].height == wanted.height;
    };
    // Those whose content stays first, lest another takes their place.
    std::vector<std::optional<gl::Texture>> textures(plan.textures.size());
    for (const Kept& pair : kept) {
        if (fits(pair.before, plan.textures[pair.now])) {
            textures[pair.now] = std::exchange(old_textures[pair.before], std::nullopt);
            keys_[pair.now] = old_keys[pair.before];
        }
    }
    for (std::size_t t = 0; t < textures.size(); ++t) {
        const PlanTexture& wanted = plan.textures[t];
        for (std::size_t o = 0; !textures[t] && o < old.size(); ++o) {
            if (fits(o, wanted)) {
                textures[t] = std::exchange(old_textures[o], std::nullopt);
            }
        }
        textures_.push_back(textures[t] ? *std::move(textures[t]) : make(gl_, wanted, t));
        descriptions_.push_back(wanted);
    }
}

void TargetPool::forget_content(std::span<const Kept> kept) {
    std::ranges::fill(backdrops_, Backdrop{});
    const std::vector<std::uint64_t> old = std::exchange(keys_, std::vector<std::uint64_t>(keys_.size(), 0));
    for (const Kept& pair : kept) {
        keys_[pair.now] = old[pair.before];
    }
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
