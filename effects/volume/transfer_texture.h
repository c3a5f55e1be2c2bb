#pragma once

#include <cstdint>
#include <optional>

#include "effects/volume/classification.h"
#include "effects/volume/source.h"
#include "engine/gl/texture.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// What a program shows of the entries of a transfer function: only those with extinction, so that hardware
/// need not look others up, or the colours of all.
enum class EntriesShown { with_extinction, all };

/// The table of a transfer function on the GPU, for glsl/volume/classify.glsl, and what it was made from.
class TransferTexture {
  public:
    explicit TransferTexture(EntriesShown shown) : shown_(shown) {}

    /// Whether the table is that of a pass's parameters, known by their key, and of the volume as it is now.
    [[nodiscard]] bool is_of(std::uint64_t parameters_key, const Source& source) const {
        return table_ && key_ == key_of(parameters_key, source);
    }
    void make(const gl::Functions& gl, const ClassificationTable& table, std::uint64_t parameters_key,
              const Source& source);
    /// Once it is made.
    void bind(const Pass& pass, const gl::Program& program) const;

  private:
    [[nodiscard]] static std::uint64_t key_of(std::uint64_t parameters_key, const Source& source);

    struct Table {
        gl::Texture entries;
        glm::dvec2 place;
        float seen;
    };
    EntriesShown shown_;
    std::optional<Table> table_;
    std::uint64_t key_ = 0;
};

}  // namespace viscera::volume
