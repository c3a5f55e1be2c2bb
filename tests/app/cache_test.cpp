#include "engine/io/volume.h"
#include "tests/app/app_test.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What `viscera render` keeps of a volume whose filter needs coefficients.
class Cache : public AppTest {
  protected:
    Cache() {
        Volume volume;
        volume.grid.dims = glm::ivec3(8);
        volume.grid.origin_mm = glm::dvec3(-3.5);
        volume.voxels.assign(8 * 8 * 8, std::byte{100});
        io::write_volume(volume, folder_ / "cube.nrrd");
        write_scene(nlohmann::json::parse(R"({
            "version": 1, "resolution": [16, 12], "camera": {"eye_mm": [0, -80, 0]},
            "passes": [{"name": "cast", "effect": "volume.ray_cast", "parameters": {
                "volume": {"file": "cube.nrrd"}, "sampling": {"filter": "bspline"},
                "transfer_function": {"points": [{"value": 0, "opacity": 0}, {"value": 200, "opacity": 0.5}]}}}],
            "outputs": ["volume.colour"]})"));
    }
    /// Whether coefficients were solved for.
    bool solves(std::vector<std::string> arguments, const Call& call = {}) {
        arguments.emplace_back("--progress");
        const Ended ended = render(arguments, call);
        expect_fine(ended);
        return ended.err.find("prefiltering cube.nrrd 100 %") != std::string::npos;
    }
};

TEST_F(Cache, AFolderIsTakenAndUsedByTheNextRun) {
    EXPECT_TRUE(solves({"--cache", path("kept")}));
    EXPECT_EQ(files("kept").size(), 1U);
    EXPECT_FALSE(solves({"--cache", path("kept")}));
    EXPECT_TRUE(solves({"--cache", "off"}));
}

TEST_F(Cache, ByDefaultItLiesWhereUsersKeepTheirCaches) {
    EXPECT_TRUE(solves({}, {.environment = {{"XDG_CACHE_HOME", path("xdg")}, {"HOME", path("home")}}}));
    EXPECT_EQ(files("xdg/viscera").size(), 1U);
    EXPECT_TRUE(solves({}, {.environment = {{"XDG_CACHE_HOME", "relative"}, {"HOME", path("home")}}}));
    EXPECT_EQ(files("home/.cache/viscera").size(), 1U);
    EXPECT_FALSE(solves({}, {.environment = {{"HOME", path("home")}}}));
    EXPECT_TRUE(solves({"--cache", "off"}, {.environment = {{"HOME", path("home")}}}));
}

TEST_F(Cache, AFolderThatCannotBeWrittenCostsTheCacheAndNotThePicture) {
    (void)folder_.write("kept", "a file");
    const Ended ended = render({"--cache", path("kept"), "--report", path("report.json")});
    expect_fine(ended);
    EXPECT_THAT(ended.err, HasSubstr("nothing is kept in the cache"));
    EXPECT_EQ(report().at("faults").at("cache.write"), 1);
    EXPECT_THAT(render({"--cache", "off"}).err, Not(HasSubstr("nothing is kept")));
}

}  // namespace
}  // namespace viscera::test
