#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/shader_source.h"
#include "engine/gl/program.h"

namespace viscera {

/// Programs by what they are made of, each compiled when it is first used.
class ShaderLibrary {
  public:
    struct Entry {
        ProgramDesc desc;
        std::unique_ptr<gl::Program> program;  ///< none until first used
    };

    /// `defines`: of all programs, before their own.
    ShaderLibrary(const gl::Functions& gl, ShaderReader reader, std::vector<std::string> defines, Log& log)
        : gl_(gl), reader_(std::move(reader)), defines_(std::move(defines)), log_(log) {}

    /// The place of a program; stays where it is as long as the library lives.
    [[nodiscard]] Entry& entry(const ProgramDesc& desc);
    /// Compiles on first use. Throws Error(gl) that names file and line.
    [[nodiscard]] const gl::Program& program(Entry& entry);
    /// Compiles everything in use again from another place. A program that fails keeps its last good form,
    /// and the log says why. Number of failures.
    int reload(ShaderReader reader);

  private:
    [[nodiscard]] std::unique_ptr<gl::Program> compile(const ProgramDesc& desc) const;

    const gl::Functions& gl_;
    ShaderReader reader_;
    std::vector<std::string> defines_;
    Log& log_;
    std::deque<Entry> entries_;
};

}  // namespace viscera
