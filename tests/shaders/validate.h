#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/shader_source.h"
#include "engine/runtime/effect.h"

namespace viscera::test {

/// What the offline validator thinks of a list of programs.
struct Verdict {
    std::vector<std::string> faults;  ///< each with the file and line it stands at
    std::size_t stages = 0;           ///< different ones that were validated
    std::size_t links = 0;            ///< different pairs of stages that were linked
};

/// glslangValidator (Debian package glslang-tools), if it is installed.
[[nodiscard]] std::optional<std::filesystem::path> find_validator();

/// Every program of every registered effect, and the presenter's.
[[nodiscard]] std::vector<ProgramDesc> all_programs();

/// Expands all programs, for software renderers and for hardware, and has each stage compiled, and each
/// vertex stage linked with its fragment stage. Stages that expand to the same text are looked at once.
[[nodiscard]] Verdict validate(const std::filesystem::path& validator,
                               const std::vector<ProgramDesc>& programs, const ShaderReader& reader);

}  // namespace viscera::test
