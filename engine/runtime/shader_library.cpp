#include "engine/runtime/shader_library.h"

#include <algorithm>

#include "engine/core/error.h"

namespace viscera {

ShaderLibrary::Entry& ShaderLibrary::entry(const ProgramDesc& desc) {
    const auto found = std::ranges::find(entries_, desc, &Entry::desc);
    return found == entries_.end() ? entries_.emplace_back(desc, nullptr) : *found;
}

const gl::Program& ShaderLibrary::program(Entry& entry) {
    if (!entry.program) {
        entry.program = compile(entry.desc);
    }
    return *entry.program;
}

int ShaderLibrary::reload(ShaderReader reader) {
    reader_ = std::move(reader);
    int failures = 0;
    for (Entry& entry : entries_) {
        if (!entry.program) {
            continue;
        }
        try {
            entry.program = compile(entry.desc);
        } catch (const Error& error) {
            ++failures;
            log_.error(std::string(error.what()) + "\nthe last good program stays in use");
        }
    }
    return failures;
}

std::unique_ptr<gl::Program> ShaderLibrary::compile(const ProgramDesc& desc) const {
    std::vector<std::string> defines = defines_;
    defines.insert(defines.end(), desc.defines.begin(), desc.defines.end());
    const auto expand = [&](const std::string& file) { return expand_shader(file, defines, reader_); };
    auto program = std::make_unique<gl::Program>(
        desc.compute.empty() ? gl::Program(gl_, expand(desc.vertex), expand(desc.fragment), to_string(desc))
                             : gl::Program::make_compute(gl_, expand(desc.compute), to_string(desc)));
    if (!program->warnings().empty()) {
        log_.debug(program->label() + ": " + program->warnings());
    }
    return program;
}

}  // namespace viscera
