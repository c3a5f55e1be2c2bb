#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "effects/register_all.h"

namespace viscera::test {
namespace {

namespace fs = std::filesystem;

struct Source {
    std::string path;  ///< from the root
    std::vector<std::string> quoted;
    std::vector<std::string> angled;
    std::string code;  ///< without comments
};

/// By hand: std::regex calls itself for each character of a comment, and a sanitizer's stack ends before a
/// long comment does.
std::string without_comments(std::string_view text) {
    std::string code;
    while (!text.empty()) {
        std::size_t comment = 0;
        if (text.starts_with("//")) {
            comment = std::min(text.find('\n'), text.size());
        } else if (text.starts_with("/*")) {
            const std::size_t end = text.find("*/", 2);
            comment = end == std::string_view::npos ? text.size() : end + 2;
        } else {
            code += text.front();
        }
        text.remove_prefix(std::max<std::size_t>(comment, 1));
    }
    return code;
}

std::vector<Source> sources_under(const std::string& folder) {
    const fs::path root = VISCERA_SOURCE_DIR;
    std::vector<Source> sources;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
        if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") {
            continue;
        }
        Source source{.path = fs::relative(entry.path(), root).string()};
        std::ifstream file(entry.path());
        std::string text;
        const std::regex include(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
        for (std::string line; std::getline(file, line); text += line + "\n") {
            if (std::smatch match; std::regex_search(line, match, include)) {
                (match[1] == "\"" ? source.quoted : source.angled).push_back(match[2]);
            }
        }
        source.code = without_comments(text);
        sources.push_back(std::move(source));
    }
    return sources;
}

bool starts_with_any(const std::string& path, const std::vector<std::string>& folders) {
    return std::ranges::any_of(folders, [&](const std::string& folder) { return path.starts_with(folder); });
}

/// What the files of each room may include of the project.
const std::map<std::string, std::vector<std::string>> may_include{
    {"engine/core", {"engine/core/"}},
    {"engine/gl", {"engine/core/", "engine/gl/", "engine/context/context"}},
    {"engine/context", {"engine/core/", "engine/context/", "engine/gl/functions.h"}},
    {"engine/io", {"engine/core/", "engine/io/"}},
    {"engine/runtime", {"engine/"}},
    {"samples", {"engine/", "effects/", "samples/"}},
    {"assets/generate", {"engine/core/", "assets/generate/"}},
};

TEST(IncludeRules, EachRoomKnowsOnlyThoseBelowIt) {
    for (const auto& [room, allowed] : may_include) {
        const auto sources = sources_under(room);
        EXPECT_FALSE(sources.empty()) << room;
        for (const Source& source : sources) {
            for (const std::string& file : source.quoted) {
                EXPECT_TRUE(starts_with_any(file, allowed)) << source.path << " includes " << file;
            }
        }
    }
}

TEST(IncludeRules, AnEffectKnowsTheEngineAndItsOwnFamily) {
    for (const Source& source : sources_under("effects")) {
        if (source.path.starts_with("effects/register_all")) {
            continue;  // the one place that knows them all
        }
        const std::string family = source.path.substr(0, source.path.find('/', 8) + 1);
        for (const std::string& file : source.quoted) {
            EXPECT_TRUE(starts_with_any(file, {"engine/", family})) << source.path << " includes " << file;
        }
    }
}

TEST(IncludeRules, OpenGlIsSpokenInItsOwnRoomOnly) {
    const std::vector<std::string> headers{"GL/", "EGL/", "GLES", "GLFW/", "glad/"};
    for (const std::string room :
         {"engine/core", "engine/io", "engine/runtime", "effects", "samples/viscera"}) {
        for (const Source& source : sources_under(room)) {
            for (const std::string& file : source.angled) {
                EXPECT_FALSE(starts_with_any(file, headers)) << source.path << " includes " << file;
            }
        }
    }
    const std::regex call(R"(\bgl[A-Z]\w*\s*\(|\bgl\(\)\.|\bgl\.[A-Z])");
    for (const std::string room : {"engine/core", "engine/io", "samples/viscera"}) {
        for (const Source& source : sources_under(room)) {
            if (source.path.starts_with("samples/viscera/bench")) {
                continue;  // it measures OpenGL itself
            }
            EXPECT_FALSE(std::regex_search(source.code, call)) << source.path << " calls OpenGL";
        }
    }
}

TEST(IncludeRules, TheEngineNamesNoEffect) {
    Registry registry;
    register_all(registry);
    for (const Source& source : sources_under("engine")) {
        for (const Registry::Entry& entry : registry.entries()) {
            EXPECT_EQ(source.code.find('"' + entry.name + '"'), std::string::npos)
                << source.path << " names " << entry.name;
        }
    }
}

TEST(IncludeRules, EveryHeaderIsGuarded) {
    for (const std::string room : {"engine", "effects", "samples", "tests"}) {
        for (const Source& source : sources_under(room)) {
            if (source.path.ends_with(".h")) {
                EXPECT_TRUE(source.code.starts_with("#pragma once")) << source.path;
            }
        }
    }
}

}  // namespace
}  // namespace viscera::test
