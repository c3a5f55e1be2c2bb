#include "engine/core/shader_source.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <utility>

#include "engine/core/error.h"

namespace viscera {
namespace {

constexpr std::string_view blanks = " \t\f\v";
constexpr std::string_view defines_file = "<defines>";

[[nodiscard]] std::string_view trim_left(std::string_view text) {
    const std::size_t start = text.find_first_not_of(blanks);
    return start == std::string_view::npos ? std::string_view{} : text.substr(start);
}

/// Cuts the first line off `text`, without its end (LF or CRLF).
[[nodiscard]] std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r')) {
        line.remove_suffix(1);
    }
    return line;
}

/// Whether a block comment is open after the line.
[[nodiscard]] bool comment_open_after(std::string_view line, bool open) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const std::string_view pair = line.substr(i, 2);
        if (open) {
            if (pair == "*/") {
                open = false;
                ++i;
            }
        } else if (pair == "//") {
            return false;
        } else if (pair == "/*") {
            open = true;
            ++i;
        }
    }
    return open;
}

/// What follows the word of a directive ("include", "version"); none when the line is not that directive.
[[nodiscard]] std::optional<std::string_view> directive(std::string_view line, std::string_view word) {
    line = trim_left(line);
    if (!line.starts_with('#')) {
        return std::nullopt;
    }
    line = trim_left(line.substr(1));
    if (!line.starts_with(word)) {
        return std::nullopt;
    }
    line.remove_prefix(word.size());
    if (!line.empty() && blanks.find(line.front()) == std::string_view::npos && line.front() != '"' &&
        line.front() != '<') {
        return std::nullopt;
    }
    return trim_left(line);
}

[[nodiscard]] std::string place(std::string_view file, int line) {
    return std::string(file) + ":" + std::to_string(line);
}

[[nodiscard]] std::string normal_name(std::string_view name) {
    return std::filesystem::path(name).lexically_normal().generic_string();
}

class IncludeExpander {
  public:
    IncludeExpander(std::span<const std::string> defines, const ShaderReader& reader)
        : defines_(defines), reader_(reader) {}

    [[nodiscard]] ShaderSource expand(std::string_view name) {
        const std::string main = normal_name(name);
        const std::optional<std::string> text = reader_(main);
        if (!text) {
            throw Error(ErrorCode::gl, main, "no such shader file");
        }
        add_file(main, *text);
        return std::move(source_);
    }

  private:
    struct Open {
        std::string file;
        int line = 0;  ///< where it was included from, in the file below it on the stack
    };

    void emit(std::string_view line, SourceLine from) {
        source_.text.append(line).push_back('\n');
        source_.lines.push_back(from);
    }

    void emit_defines() {
        int number = 0;
        for (const std::string& define : defines_) {
            if (define.empty() || define.find_first_of("\r\n\\") != std::string::npos) {
                throw Error(ErrorCode::gl, source_.files.front(), "not a define: '" + define + "'");
            }
            emit("#define " + define, {ShaderSource::npos, ++number});
        }
    }

    void add_file(const std::string& name, std::string_view text) {
        const std::size_t file = source_.files.size();
        source_.files.push_back(name);
        open_.push_back({name, 0});
        if (text.starts_with("\xEF\xBB\xBF")) {
            text.remove_prefix(3);
        }
        bool in_comment = false;
        int comment_line = 0;
        int number = 0;
        while (!text.empty() || (file == 0 && number == 0)) {
            const std::string_view line = take_line(text);
            ++number;
            open_.back().line = number;
            if (number == 1 && file == 0) {
                add_version(line);
                continue;
            }
            if (const auto rest = directive(line, "include"); rest && !in_comment) {
                add_include(*rest);
                continue;
            }
            const bool was_in_comment = std::exchange(in_comment, comment_open_after(line, in_comment));
            if (in_comment && !was_in_comment) {
                comment_line = number;
            }
            emit(line, {file, number});
        }
        if (in_comment) {
            throw Error(ErrorCode::gl, place(name, comment_line), "comment is not closed");
        }
        open_.pop_back();
    }

    void add_version(std::string_view line) {
        if (!directive(line, "version")) {
            throw Error(ErrorCode::gl, place(source_.files.front(), 1), "the first line must be #version");
        }
        emit(line, {0, 1});
        emit_defines();
    }

    void add_include(std::string_view rest) {
        const std::size_t end = rest.starts_with('"') ? rest.find('"', 1) : std::string_view::npos;
        if (end == std::string_view::npos || end == 1) {
            fail("expected #include \"name\"");
        }
        const std::string_view after = trim_left(rest.substr(end + 1));
        if (!after.empty() && !after.starts_with("//")) {
            fail("unexpected text after the name of the include");
        }
        const std::string name = normal_name(rest.substr(1, end - 1));
        if (std::ranges::any_of(open_, [&](const Open& open) { return open.file == name; })) {
            fail("include cycle: " + chain(name));
        }
        if (std::ranges::find(source_.files, name) != source_.files.end()) {
            return;
        }
        const std::optional<std::string> text = reader_(name);
        if (!text) {
            fail("no such shader file: \"" + name + "\"" +
                 (open_.size() > 1 ? " (" + chain(name) + ")" : ""));
        }
        add_file(name, *text);
    }

    [[nodiscard]] std::string chain(const std::string& last) const {
        std::string text;
        for (const Open& open : open_) {
            text += place(open.file, open.line) + " -> ";
        }
        return text + last;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw Error(ErrorCode::gl, place(open_.back().file, open_.back().line), message);
    }

    std::span<const std::string> defines_;
    const ShaderReader& reader_;
    ShaderSource source_;
    std::vector<Open> open_;
};

/// A line number in a driver's message: the characters [begin, end) are to be replaced.
struct LogPlace {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t line = 0;
};

/// Reads digits from `at` on and moves `at` past them.
[[nodiscard]] std::optional<std::size_t> take_number(std::string_view text, std::size_t& at) {
    std::size_t value = 0;
    const char* const first = text.data() + at;
    const auto [last, error] = std::from_chars(first, text.data() + text.size(), value);
    if (error != std::errc{}) {
        return std::nullopt;
    }
    at += static_cast<std::size_t>(last - first);
    return value;
}

/// Finds "0:12(5):" (Mesa), "0(12) :" (NVIDIA), "ERROR: 0:12:" (glslang, AMD) at the start of a message.
[[nodiscard]] std::optional<LogPlace> find_place(std::string_view message) {
    LogPlace found;
    std::size_t at = message.size() - trim_left(message).size();
    for (const std::string_view severity : {"ERROR:", "WARNING:", "NOTE:", "INFO:"}) {
        if (message.substr(at).starts_with(severity)) {
            at += severity.size();
            at = message.size() - trim_left(message.substr(at)).size();
        }
    }
    found.begin = at;
    // Only string 0 is ours; a driver numbers the strings of one shader, and we hand it one.
    if (take_number(message, at) != 0U || at >= message.size()) {
        return std::nullopt;
    }
    const char opening = message[at++];
    const std::optional<std::size_t> line = take_number(message, at);
    if (!line || at >= message.size()) {
        return std::nullopt;
    }
    found.line = *line;
    if (opening == ':' && (message[at] == '(' || message[at] == ':')) {
        found.end = at;
        return found;
    }
    if (opening == '(' && message[at] == ')') {
        found.end = at + 1;
        // NVIDIA writes a blank before the colon.
        if (message.substr(found.end).starts_with(" :")) {
            ++found.end;
        }
        return found;
    }
    return std::nullopt;
}

}  // namespace

ShaderReader shader_reader_from_folder(std::filesystem::path folder) {
    return [folder = std::move(folder)](std::string_view name) -> std::optional<std::string> {
        const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
        if (relative.is_absolute() || relative.empty() || *relative.begin() == "..") {
            return std::nullopt;
        }
        const std::filesystem::path path = folder / relative;
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error)) {
            return std::nullopt;
        }
        std::ifstream stream(path, std::ios::binary);
        std::string text((std::istreambuf_iterator<char>(stream)), {});
        return stream.bad() || !stream.is_open() ? std::nullopt : std::optional(std::move(text));
    };
}

ShaderSource expand_shader(std::string_view name, std::span<const std::string> defines,
                           const ShaderReader& reader) {
    return IncludeExpander(defines, reader).expand(name);
}

std::string map_shader_log(std::string_view log, const ShaderSource& source) {
    std::string mapped;
    while (!log.empty()) {
        const std::size_t before = log.size();
        const std::string_view message = take_line(log);
        const std::string_view ending(message.data() + message.size(), before - log.size() - message.size());
        const std::optional<LogPlace> found = find_place(message);
        // Past the last line stands what a driver says of the end of the text.
        if (!found || found->line == 0 || source.lines.empty() || found->line > source.lines.size() + 1) {
            mapped.append(message).append(ending);
            continue;
        }
        const SourceLine& from = source.lines[std::min(found->line, source.lines.size()) - 1];
        mapped.append(message.substr(0, found->begin))
            .append(
                place(from.file < source.files.size() ? source.files[from.file] : defines_file, from.line))
            .append(message.substr(found->end))
            .append(ending);
    }
    return mapped;
}

std::string to_string(const ProgramDesc& program) {
    std::string text = !program.compute.empty()   ? program.compute
                       : program.fragment.empty() ? program.vertex
                                                  : program.fragment;
    std::string_view separator = "[";
    for (std::string define : program.defines) {
        std::ranges::replace(define, ' ', '=');
        text.append(separator).append(define);
        separator = ",";
    }
    return program.defines.empty() ? text : text + "]";
}

}  // namespace viscera
