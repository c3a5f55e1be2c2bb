#include "engine/runtime/embedded_shaders.h"

#include <algorithm>

namespace viscera {
namespace {

[[nodiscard]] std::optional<std::string> find(std::span<const EmbeddedShader> table, std::string_view name) {
    const auto found = std::ranges::find(table, name, &EmbeddedShader::name);
    return found == table.end() ? std::nullopt : std::optional<std::string>(found->text);
}

}  // namespace

std::optional<std::string> embedded_shader(std::string_view name) {
    return find(embedded_shader_table(), name);
}

std::vector<std::string_view> embedded_shader_names() {
    std::vector<std::string_view> names;
    for (const EmbeddedShader& shader : embedded_shader_table()) {
        names.push_back(shader.name);
    }
    return names;
}

ShaderReader embedded_shader_reader() {
    return embedded_shader;
}

ShaderReader embedded_shader_reader(std::span<const EmbeddedShader> table) {
    return [table](std::string_view name) {
        std::optional<std::string> own = find(table, name);
        return own ? own : embedded_shader(name);
    };
}

}  // namespace viscera
