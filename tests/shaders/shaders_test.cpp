#include <algorithm>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "engine/runtime/embedded_shaders.h"
#include "tests/io/temp_folder.h"
#include "tests/shaders/validate.h"

// Every shader that may ever be compiled, looked at without a GPU by a compiler that is stricter than
// drivers.
namespace viscera::test {
namespace {

const std::filesystem::path glsl = std::filesystem::path(VISCERA_SOURCE_DIR) / "glsl";

/// The embedded shaders with one piece of one file's text replaced.
ShaderReader with_change(const std::string& file, const std::string& from, const std::string& to) {
    return [=, original = embedded_shader_reader()](std::string_view name) {
        std::optional<std::string> text = original(name);
        if (text && name == file) {
            const std::size_t at = text->find(from);
            EXPECT_NE(at, std::string::npos) << file << " no longer says: " << from;
            text->replace(at == std::string::npos ? 0 : at, at == std::string::npos ? 0 : from.size(), to);
        }
        return text;
    };
}

class Shaders : public testing::Test {
  protected:
    void SetUp() override {
        if (!validator_) {
            GTEST_SKIP() << "glslangValidator is not installed (Debian package glslang-tools)";
        }
    }
    /// Programs that use a file.
    static std::vector<ProgramDesc> programs_of(const std::string& file) {
        std::vector<ProgramDesc> programs = all_programs();
        std::erase_if(programs, [&](const ProgramDesc& p) { return p.vertex != file && p.fragment != file; });
        return programs;
    }
    std::optional<std::filesystem::path> validator_ = find_validator();
};

TEST_F(Shaders, EveryVariantOfEveryEffectIsValid) {
    const std::vector<ProgramDesc> programs = all_programs();
    const Verdict verdict = validate(*validator_, programs, embedded_shader_reader());
    std::printf("  %zu programs, %zu different stages, %zu different links\n", programs.size(),
                verdict.stages, verdict.links);
    EXPECT_GT(verdict.stages, 50U);
    for (const std::string& fault : verdict.faults) {
        ADD_FAILURE() << fault;
    }
}

TEST_F(Shaders, BoxesHaveNothingOfCurvilinearVolumesInTheirs) {
    // The coordinate system is an include: whatever stands in those of rings, a box's shader is the same.
    const std::set<std::string, std::less<>> curved{"volume/curvilinear.glsl",
                                                    "volume/curvilinear_limits.glsl",
                                                    "volume/coordinates_cylindrical.glsl",
                                                    "volume/coordinates_spherical.glsl",
                                                    "volume/place_cylindrical.glsl",
                                                    "volume/place_spherical.glsl",
                                                    "volume/skip_curvilinear.glsl"};
    for (const std::string& file : curved) {
        EXPECT_TRUE(std::filesystem::exists(glsl / file)) << file;
    }
    const ShaderReader spoilt = [&, original = embedded_shader_reader()](std::string_view name) {
        return curved.contains(name) ? std::optional<std::string>("this is no shader;\n") : original(name);
    };
    std::vector<ProgramDesc> boxes;
    std::vector<ProgramDesc> rings;
    for (const ProgramDesc& program : programs_of("volume/ray_cast.frag")) {
        const bool ring = std::ranges::any_of(
            program.defines, [](const std::string& define) { return define.starts_with("COORDINATES"); });
        (ring ? rings : boxes).push_back(program);
    }
    // Some of each sort: all would take as long as the test of every variant.
    const auto thinned = [](const std::vector<ProgramDesc>& programs, std::size_t count) {
        std::vector<ProgramDesc> some;
        for (std::size_t i = 0; i < count; ++i) {
            some.push_back(programs.at(i * programs.size() / count));
        }
        return some;
    };
    const Verdict straight = validate(*validator_, thinned(boxes, 25), spoilt);
    EXPECT_EQ(straight.faults, std::vector<std::string>{});
    EXPECT_GT(straight.stages, 10U);
    EXPECT_FALSE(validate(*validator_, thinned(rings, 3), spoilt).faults.empty());
}

TEST_F(Shaders, ABrokenShaderIsNamedWithItsLine) {
    const Verdict verdict = validate(*validator_, programs_of("filter/gaussian.frag"),
                                     with_change("filter/gaussian.frag", "float sum = ", "flaot sum = "));
    ASSERT_FALSE(verdict.faults.empty());
    EXPECT_NE(verdict.faults.front().find("filter/gaussian.frag:"), std::string::npos)
        << verdict.faults.front();
}

TEST_F(Shaders, AnErrorInAnIncludedFileIsNamedThere) {
    const Verdict verdict =
        validate(*validator_, programs_of("contrast/geometry.frag"),
                 with_change("contrast/opacity.glsl", "return min(1.0", "return min(1.0, 2.0, 3.0"));
    ASSERT_FALSE(verdict.faults.empty());
    EXPECT_NE(verdict.faults.front().find("contrast/opacity.glsl:"), std::string::npos)
        << verdict.faults.front();
}

TEST_F(Shaders, StagesThatDoNotFitAreFound) {
    const Verdict verdict =
        validate(*validator_, programs_of("filter/gaussian.frag"),
                 with_change("filter/gaussian.frag", "in vec2 v_uv;", "in vec3 v_uv;\n#define v_uv v_uv.xy"));
    ASSERT_FALSE(verdict.faults.empty());
    EXPECT_NE(verdict.faults.front().find("Types must match"), std::string::npos) << verdict.faults.front();
}

TEST(ShaderFiles, EmbeddedTextIsTheFilesOnDisk) {
    std::set<std::string> on_disk;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(glsl)) {
        if (entry.is_regular_file()) {
            on_disk.insert(std::filesystem::relative(entry.path(), glsl).generic_string());
        }
    }
    std::set<std::string> embedded;
    for (const std::string_view name : embedded_shader_names()) {
        embedded.emplace(name);
        EXPECT_EQ(embedded_shader(name), slurp(glsl / name)) << name;
    }
    EXPECT_EQ(embedded, on_disk);
}

TEST(ShaderFiles, EveryFileIsUsed) {
    std::set<std::string> used;
    for (const ProgramDesc& program : all_programs()) {
        for (const std::string& stage : {program.vertex, program.fragment, program.compute}) {
            if (!stage.empty()) {
                const ShaderSource source = expand_shader(stage, program.defines, embedded_shader_reader());
                used.insert(source.files.begin(), source.files.end());
            }
        }
    }
    for (const std::string_view name : embedded_shader_names()) {
        EXPECT_TRUE(used.contains(std::string(name))) << name << " belongs to no program";
    }
}

}  // namespace
}  // namespace viscera::test
