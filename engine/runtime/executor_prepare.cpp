#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/core/size_text.h"
#include "engine/runtime/executor.h"
#include "engine/runtime/naming_pass.h"

// What a frame brings, and what each pass finds to do in it.
namespace viscera {
namespace {

/// Size of what a pass draws into [pixels]; {0, 0} when nobody needs any of it.
glm::ivec2 target_size(const Plan& plan, const PlanPass& pass) {
    for (const PlanBinding& binding : pass.bindings) {
        if (binding.content && makes_content(binding.access)) {
            const PlanContent& content = plan.contents[*binding.content];
            return {content.width, content.height};
        }
    }
    return {0, 0};
}

/// Throws Error(usage) unless a lent texture is what its host says: a size that is not its own would be read
/// beside the texture.
void check_import(const gl::Functions& gl, const ImportedTexture& lent) {
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::usage, lent.target,
                    "the imported texture " + std::to_string(lent.texture) + " " + why);
    };
    if (lent.texture == 0 || gl.IsTexture(lent.texture) == GL_FALSE) {
        refuse("does not exist in this context");
    }
    gl.ActiveTexture(GL_TEXTURE0 + gl::editing_unit);
    gl.BindTexture(GL_TEXTURE_2D, lent.texture);
    if (gl::drain_errors(gl) != GL_NO_ERROR) {
        refuse("is not a 2-D texture");
    }
    const auto ask = [&](GLenum what) {
        GLint value = 0;
        gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, what, &value);
        return value;
    };
    const int width = ask(GL_TEXTURE_WIDTH);
    const int height = ask(GL_TEXTURE_HEIGHT);
    if (width != lent.width || height != lent.height) {
        refuse("is " + size_text({width, height}) + ", not " + size_text({lent.width, lent.height}));
    }
    if ((ask(GL_TEXTURE_DEPTH_SIZE) > 0) != info(lent.format).is_depth) {
        refuse(info(lent.format).is_depth ? "holds no depth" : "holds depth, not colour");
    }
}

}  // namespace

/// One pass's view of the frame while works are collected.
class Executor::FramePrepare final : public Prepare {
  public:
    FramePrepare(Executor& executor, const Frame& frame, std::size_t pass)
        : executor_(executor), frame_(frame), pass_(pass) {}

    const Frame& frame() const override { return frame_; }
    Assets& assets() override { return executor_.shared_.assets; }
    Log& log() override { return executor_.shared_.log; }
    std::uint64_t parameters_key() const override { return executor_.passes_[pass_].parameters_key; }
    bool has(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        if (binding == nullptr || !binding->content) {
            return false;
        }
        return makes_content(binding->access) || !executor_.schedule_.contents()[*binding->content].empty;
    }
    glm::ivec2 size(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        if (binding == nullptr || !binding->content) {
            return {0, 0};
        }
        const PlanContent& content = executor_.plan_.contents[*binding->content];
        return {content.width, content.height};
    }

    std::uint64_t subject(std::string_view port) const override {
        const PlanBinding* binding = find(port);
        return binding == nullptr || !binding->content ? 0 : executor_.subjects_[*binding->content];
    }

    std::uint64_t content(std::string_view port) const override {
        return has(port) ? executor_.schedule_.contents()[*find(port)->content].key : 0;
    }

  private:
    const PlanBinding* find(std::string_view port) const {
        const auto& bindings = executor_.plan_.passes[pass_].bindings;
        const auto found = std::ranges::find(bindings, port, &PlanBinding::port);
        return found == bindings.end() ? nullptr : &*found;
    }

    Executor& executor_;
    const Frame& frame_;
    std::size_t pass_;
};

void Executor::see(const Frame& frame) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        Frame& seen = frames_[i];
        seen = frame;
        seen.eye_count = i == 0 ? 0 : 1;
        seen.eye_index = i == 2 ? 1 : 0;
        if (i == 2) {
            seen.eyes[0] = frame.eyes[1];
        }
    }
}

void Executor::import(const Frame& frame) {
    imported_textures_.clear();
    imported_keys_.clear();
    for (const ImportedTarget& target : imported_) {
        const auto found = std::ranges::find(frame.imported, target.name, &ImportedTexture::target);
        check_import(shared_.gl, *found);
        // A host may have deleted a texture and made another of the same name, which no framebuffer made
        // before then holds.
        if (target.writable) {
            pool_.forget_framebuffers(found->texture);
        }
        imported_textures_.push_back(gl::Texture::wrap(shared_.gl, found->texture, GL_TEXTURE_2D,
                                                       {found->width, found->height},
                                                       gl::texture_format(found->format)));
        imported_keys_.push_back(
            found->version == 0 ? 0 : Hash().add(found->texture).add(found->version).value());
    }
}

void Executor::prepare(FrameReport& report) {
    report.passes.resize(passes_.size());
    schedule_.begin(plan_, pool_.keys(), imported_keys_);
    subjects_.assign(plan_.contents.size(), 0);
    for (std::size_t p = 0; p < passes_.size(); ++p) {
        PassState& state = passes_[p];
        const PlanPass& pass = plan_.passes[p];
        report.passes[p].name = pass.name;
        report.passes[p].effect = pass.effect;
        report.passes[p].eye = state.origin.eye;
        report.passes[p].cpu_ms = 0.0;
        report.passes[p].path.reset();
        if (!pass.live) {
            continue;
        }
        const gl::CpuTimer timer;
        FramePrepare view(*this, frames_[state.frame], p);
        state.work = naming_pass(pass.name, [&] { return state.effect->prepare(view); });
        // An effect may ask for more than there is.
        const glm::ivec2 size = target_size(plan_, pass);
        state.work.region = state.work.region.confined(size.x, size.y);
        PassWork work{.idle = state.work.kind == Work::Kind::idle,
                      .region = state.work.kind == Work::Kind::region,
                      .key = state.work.key,
                      .reason = state.work.reason,
                      .update = state.work.kind == Work::Kind::update,
                      .touched = state.work.region,
                      .rests = state.work.rests};
        for (std::size_t b = 0; b < state.port_of_binding.size(); ++b) {
            work.empty_bindings |= ((state.work.empty_outputs >> state.port_of_binding[b]) & 1U) << b;
        }
        schedule_.work(plan_, p, work);
        pass_on_subject(pass, state.work.subject);
        report.passes[p].cpu_ms = timer.milliseconds();
    }
    schedule_.decide(plan_);
}

/// A pass's outputs belong to what it says, or to what its inputs belong to.
void Executor::pass_on_subject(const PlanPass& pass, std::uint64_t subject) {
    for (const PlanBinding& binding : pass.bindings) {
        if (subject == 0 && binding.content && !makes_content(binding.access)) {
            subject = subjects_[*binding.content];
        }
    }
    for (const PlanBinding& binding : pass.bindings) {
        if (binding.content && makes_content(binding.access)) {
            subjects_[*binding.content] = subject;
        }
    }
}

}  // namespace viscera
