#include "engine/core/shader_source.h"

#include <filesystem>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"

namespace viscera {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

[[nodiscard]] ShaderReader files(std::map<std::string, std::string, std::less<>> texts) {
    return [texts = std::move(texts)](std::string_view name) -> std::optional<std::string> {
        const auto found = texts.find(name);
        return found == texts.end() ? std::nullopt : std::optional(found->second);
    };
}

[[nodiscard]] ShaderSource expand(const ShaderReader& reader, const std::vector<std::string>& defines = {}) {
    return expand_shader("main.frag", defines, reader);
}

[[nodiscard]] std::string error_of(const ShaderReader& reader, const std::vector<std::string>& defines = {}) {
    try {
        (void)expand(reader, defines);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::gl);
        return error.what();
    }
    return "no error";
}

TEST(ExpandShader, KeepsAPlainFile) {
    const ShaderSource source = expand(files({{"main.frag", "#version 330 core\nvoid main() {}\n"}}));
    EXPECT_EQ(source.text, "#version 330 core\nvoid main() {}\n");
    EXPECT_THAT(source.files, ElementsAre("main.frag"));
    ASSERT_EQ(source.lines.size(), 2U);
    EXPECT_EQ(source.lines[1].line, 2);
}

TEST(ExpandShader, PutsDefinesAfterVersion) {
    const ShaderSource source =
        expand(files({{"main.frag", "#version 330 core\nvoid main() {}"}}), {"CLOUD", "STEPS 4"});
    EXPECT_EQ(source.text, "#version 330 core\n#define CLOUD\n#define STEPS 4\nvoid main() {}\n");
    EXPECT_EQ(source.lines[1].file, ShaderSource::npos);
    EXPECT_EQ(source.lines[3].file, 0U);
    EXPECT_EQ(source.lines[3].line, 2);
}

TEST(ExpandShader, IncludesEachFileOnceAndKeepsTheLineTable) {
    const ShaderSource source = expand(files({
        {"main.frag",
         "#version 330 core\n#include \"a.glsl\"\n  # include \"common/b.glsl\"  // again\nmain"},
        {"a.glsl", "#include \"common/b.glsl\"\na"},
        {"common/b.glsl", "b1\nb2\n"},
    }));
    EXPECT_EQ(source.text, "#version 330 core\nb1\nb2\na\nmain\n");
    EXPECT_THAT(source.files, ElementsAre("main.frag", "a.glsl", "common/b.glsl"));
    const std::vector<std::pair<std::size_t, int>> expected{{0, 1}, {2, 1}, {2, 2}, {1, 2}, {0, 4}};
    ASSERT_EQ(source.lines.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(source.lines[i].file, expected[i].first) << i;
        EXPECT_EQ(source.lines[i].line, expected[i].second) << i;
    }
}

TEST(ExpandShader, TakesTwoSpellingsOfAPathAsOneFile) {
    const ShaderSource source = expand(files({
        {"main.frag", "#version 330\n#include \"c/a.glsl\"\n#include \"c/../c/./a.glsl\"\n"},
        {"c/a.glsl", "a\n"},
    }));
    EXPECT_EQ(source.text, "#version 330\na\n");
}

TEST(ExpandShader, ToleratesCarriageReturnsAndByteOrderMark) {
    const ShaderSource source = expand(files({
        {"main.frag", "\xEF\xBB\xBF#version 330 core\r\n#include \"a.glsl\"\r\nend\r\n"},
        {"a.glsl", "a\r\nb"},
    }));
    EXPECT_EQ(source.text, "#version 330 core\na\nb\nend\n");
}

TEST(ExpandShader, LeavesIncludesInCommentsAndMidLineAlone) {
    const std::string text =
        "#version 330 core\n// #include \"x\"\n/* a\n#include \"x\"\n*/ int a; // /*\nint b; #include \"x\"\n"
        "/**/ int c; /* // */\nint d; /*/\n#include \"x\"\n*/\n";
    EXPECT_EQ(expand(files({{"main.frag", text}})).text, text);
}

TEST(ExpandShader, IncludesAgainAfterACommentClosed) {
    EXPECT_EQ(expand(files({{"main.frag", "#version 330\n/* x */\n#include \"a\"\n"}, {"a", "a\n"}})).text,
              "#version 330\n/* x */\na\n");
}

TEST(ExpandShader, KeepsOtherDirectives) {
    const std::string text = "#version 330 core\n#if defined(A)\n#included\n#endif\n";
    EXPECT_EQ(expand(files({{"main.frag", text}})).text, text);
}

TEST(ExpandShader, EmptyIncludeAddsNothing) {
    EXPECT_EQ(expand(files({{"main.frag", "#version 330\n#include \"a\"\nb"}, {"a", ""}})).text,
              "#version 330\nb\n");
}

TEST(ExpandShader, NamesWhatIsMissing) {
    EXPECT_EQ(error_of(files({})), "main.frag: no such shader file");
    EXPECT_EQ(error_of(files({{"main.frag", "#version 330\n\n#include \"a.glsl\""}})),
              "main.frag:3: no such shader file: \"a.glsl\"");
    EXPECT_EQ(error_of(files(
                  {{"main.frag", "#version 330\n#include \"a.glsl\""}, {"a.glsl", "\n\n#include \"b\""}})),
              "a.glsl:3: no such shader file: \"b\" (main.frag:2 -> a.glsl:3 -> b)");
}

TEST(ExpandShader, NamesTheChainOfACycle) {
    EXPECT_EQ(error_of(files({
                  {"main.frag", "#version 330\n#include \"a.glsl\"\n"},
                  {"a.glsl", "\n#include \"b.glsl\"\n"},
                  {"b.glsl", "#include \"a.glsl\"\n"},
              })),
              "b.glsl:1: include cycle: main.frag:2 -> a.glsl:2 -> b.glsl:1 -> a.glsl");
    EXPECT_THAT(error_of(files({{"main.frag", "#version 330\n#include \"main.frag\"\n"}})),
                HasSubstr("main.frag:2: include cycle"));
}

TEST(ExpandShader, WantsVersionFirst) {
    for (const char* text :
         {"", "\n#version 330\n", "// shader\n#version 330\n", "#versions\n", "void main(){}"}) {
        EXPECT_EQ(error_of(files({{"main.frag", text}})), "main.frag:1: the first line must be #version")
            << text;
    }
}

TEST(ExpandShader, RefusesMalformedIncludesAndDefines) {
    for (const char* line :
         {"#include", "#include <a>", "#include \"a", "#include \"\"", "#include a", "#include \"a\" b"}) {
        EXPECT_THAT(error_of(files({{"main.frag", "#version 330\n" + std::string(line)}, {"a", ""}})),
                    testing::StartsWith("main.frag:2: "))
            << line;
    }
    const ShaderReader plain = files({{"main.frag", "#version 330\n"}});
    EXPECT_THAT(error_of(plain, {""}), HasSubstr("not a define"));
    EXPECT_THAT(error_of(plain, {"A 1\nB"}), HasSubstr("not a define"));
    EXPECT_THAT(error_of(files({{"main.frag", "#version 330\n#include \"a\"\n"}, {"a", "\n/* open"}})),
                HasSubstr("a:2: comment is not closed"));
}

class MapShaderLog : public testing::Test {
  protected:
    const ShaderSource source_ = expand(files({
                                            {"main.frag", "#version 330\n#include \"lib.glsl\"\nmain1\n"},
                                            {"lib.glsl", "lib1\nlib2\n"},
                                        }),
                                        {"A"});
    // 1 version, 2 define, 3 lib1, 4 lib2, 5 main1

    [[nodiscard]] std::string map(std::string_view log) const { return map_shader_log(log, source_); }
};

TEST_F(MapShaderLog, Mesa) {
    EXPECT_EQ(map("0:4(13): error: `foo' undeclared\n0:5(1): preprocessor error: x\n"),
              "lib.glsl:2(13): error: `foo' undeclared\nmain.frag:3(1): preprocessor error: x\n");
}

TEST_F(MapShaderLog, Nvidia) {
    EXPECT_EQ(map("0(4) : error C1503: undefined variable \"foo\"\n0(5) : warning C7050: x"),
              "lib.glsl:2: error C1503: undefined variable \"foo\"\nmain.frag:3: warning C7050: x");
}

TEST_F(MapShaderLog, GlslangAndAmd) {
    EXPECT_EQ(map("ERROR: 0:3: 'foo' : undeclared identifier \r\nERROR: 1 compilation errors.\n"),
              "ERROR: lib.glsl:1: 'foo' : undeclared identifier \r\nERROR: 1 compilation errors.\n");
    EXPECT_EQ(map("WARNING: 0:5: warning(#266) x"), "WARNING: main.frag:3: warning(#266) x");
}

TEST_F(MapShaderLog, LinesMadeHereAndPastTheEnd) {
    EXPECT_EQ(map("0:2(9): error: x"), "<defines>:1(9): error: x");
    EXPECT_EQ(map("0:6(1): error: end of file"), "main.frag:3(1): error: end of file");
}

TEST_F(MapShaderLog, LeavesTheRestAlone) {
    for (const char* log :
         {"", "\n", "0", "0:", "0(", "0:4", "0(4", "0:0(1): x", "0:7(1): x", "1:4(1): x",
          "ERROR:", "link failed: 0:4(1)", "0:99999999999999999999999(1): x", "0:-4(1): x"}) {
        EXPECT_EQ(map(log), log);
    }
    EXPECT_EQ(map_shader_log("0:1(1): x", ShaderSource{}), "0:1(1): x");
}

TEST(ShaderReaderFromFolder, ReadsBelowItsFolderOnly) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "shader_source_test";
    std::filesystem::create_directories(folder / "inside" / "deep");
    std::ofstream(folder / "outside.glsl") << "outside";
    std::ofstream(folder / "inside" / "deep" / "a.glsl") << "inside";
    const ShaderReader read = shader_reader_from_folder(folder / "inside");
    EXPECT_EQ(read("deep/a.glsl"), "inside");
    EXPECT_EQ(read("deep"), std::nullopt);
    EXPECT_EQ(read("none.glsl"), std::nullopt);
    EXPECT_EQ(read(""), std::nullopt);
    EXPECT_EQ(read("../outside.glsl"), std::nullopt);
    EXPECT_EQ(read("deep/../../outside.glsl"), std::nullopt);
    EXPECT_EQ(read((folder / "outside.glsl").string()), std::nullopt);
    std::filesystem::remove_all(folder);
}

TEST(ProgramName, ShowsFileAndDefines) {
    EXPECT_EQ(to_string(ProgramDesc{"a.vert", "b.frag", {}}), "b.frag");
    EXPECT_EQ(to_string(ProgramDesc{"a.vert", "b.frag", {"CLOUD", "STEPS 4"}}), "b.frag[CLOUD,STEPS=4]");
    EXPECT_EQ(to_string(ProgramDesc{"a.vert", "", {"X"}}), "a.vert[X]");
}

}  // namespace
}  // namespace viscera
