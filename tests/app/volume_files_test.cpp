#include <fstream>

#include "engine/io/volume.h"
#include "tests/app/app_test.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;

/// What `viscera info` and `viscera render` say of volumes that cannot be shown.
class VolumeFiles : public AppTest {
  protected:
    VolumeFiles() { use("cube.nrrd"); }

    void use(const std::string& file) {
        nlohmann::json scene = nlohmann::json::parse(R"({
            "version": 1, "resolution": [16, 12], "camera": {"eye_mm": [0, -80, 0]},
            "passes": [{"name": "cast", "effect": "volume.ray_cast", "parameters": {
                "volume": {}, "function": "mip",
                "transfer_function": {"window": {"width": 255, "level": 127.5}}}}],
            "outputs": ["volume.colour"]})");
        scene["passes"][0]["parameters"]["volume"]["file"] = file;
        write_scene(scene);
    }
    static Volume cube() {
        Volume volume;
        volume.grid.dims = {8, 6, 4};
        for (int i = 0; i < 8 * 6 * 4; ++i) {
            volume.voxels.push_back(static_cast<std::byte>(i));
        }
        return volume;
    }
    /// Both commands refuse the file with one code and say these words and its name.
    void expect_both_refuse(const std::string& name, int code, const std::string& words) {
        use(name);
        for (const Ended& ended : {viscera({"info", path(name)}), render()}) {
            expect_refused(ended, code, words);
            EXPECT_THAT(ended.err, HasSubstr(name));
        }
        EXPECT_TRUE(files().empty()) << "nothing is written for " << name;
    }
    [[nodiscard]] std::string written(const std::string& name) const {
        io::write_volume(cube(), folder_ / name);
        return slurp(folder_ / name);
    }
    /// The text with one part put in place of another.
    static std::string with(std::string text, const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    }
};

TEST_F(VolumeFiles, DamageIsToldByNameOfFileAndField) {
    const std::string nrrd = written("a.nrrd");
    (void)folder_.write("a.nrrd", nrrd.substr(0, nrrd.size() - 20));
    expect_both_refuse("a.nrrd", 4, "trunc");
    (void)folder_.write("b.nrrd", with(nrrd, "sizes: 8 6 4", "sizes: 8 6 0"));
    expect_both_refuse("b.nrrd", 4, "sizes");
    (void)folder_.write("c.nrrd", with(nrrd, "type: uint8", "type: block"));
    expect_both_refuse("c.nrrd", 4, "type 'block'");
    const std::string mha = written("a.mha");
    (void)folder_.write("d.mha", with(mha, "ElementSpacing = 1 1 1", "ElementSpacing = 1 0 1"));
    expect_both_refuse("d.mha", 4, "ElementSpacing");
    (void)folder_.write("e.vtk",
                        "# vtk DataFile Version 3.0\n\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 6\n");
    expect_both_refuse("e.vtk", 4, "DIMENSIONS");
    expect_both_refuse("missing.nrrd", 4, "does not exist");
}

TEST_F(VolumeFiles, WhatMemoryCannotHoldIsOfferedReduced) {
    // 512 GiB of zeros that take no room on disk.
    (void)folder_.write("huge.json", R"({"file": "huge.raw", "dims": [8192, 8192, 8192], "type": "u8"})");
    (void)folder_.write("huge.raw", "");
    std::error_code error;
    std::filesystem::resize_file(folder_ / "huge.raw", std::uintmax_t{1} << 39U, error);
    if (error) {
        GTEST_SKIP() << "no sparse files here: " << error.message();
    }
    expect_both_refuse("huge.json", 7, "8192 x 8192 x 8192 voxels need 524288 MiB of memory, there are ");
    EXPECT_THAT(render().err, HasSubstr("reduce = "));
}

TEST_F(VolumeFiles, WhatTheDeviceCannotHoldIsOfferedReduced) {
    Volume volume;
    volume.grid.dims = {40000, 2, 2};
    volume.voxels.resize(volume.grid.voxel_count());
    io::write_volume(volume, folder_ / "long.nrrd");
    use("long.nrrd");
    const Ended ended = render();
    expect_refused(ended, 7, "volume.reduce = ");
    EXPECT_THAT(ended.err, HasSubstr("long.nrrd"));
    const std::size_t at = ended.err.find("volume.reduce = ");
    const std::string factor =
        ended.err.substr(at + 16, ended.err.find_first_not_of("0123456789", at + 16) - at - 16);
    expect_fine(render({"--set", "/passes/0/parameters/volume/reduce=" + factor}));
}

}  // namespace
}  // namespace viscera::test
