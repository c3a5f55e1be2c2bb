#include "engine/io/vtp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/io/mesh.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::base64;
using test::bytes_of;
using test::TempFolder;
using testing::HasSubstr;

struct Packing {
    bool big_endian;
    bool wide_header;
    bool zlib;
    const char* format;  ///< binary, raw or base64
};

template <class T>
std::string ordered(T value, bool big_endian) {
    std::string bytes = bytes_of(value);
    if (big_endian) {
        std::ranges::reverse(bytes);
    }
    return bytes;
}

std::string header(std::size_t value, const Packing& p) {
    return p.wide_header ? ordered(std::uint64_t{value}, p.big_endian)
                         : ordered(static_cast<std::uint32_t>(value), p.big_endian);
}

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             bytes.size());
    packed.resize(size);
    return packed;
}

/// The array as VTK writes it: header and bytes, packed ones in two blocks with the header encoded on its
/// own.
template <class T>
std::string encoded(const std::vector<double>& values, const Packing& p) {
    std::string bytes;
    for (const double value : values) {
        bytes += ordered(static_cast<T>(value), p.big_endian);
    }
    const bool text = std::string_view(p.format) != "raw";
    if (!p.zlib) {
        const std::string all = header(bytes.size(), p) + bytes;
        return text ? base64(all) : all;
    }
    const std::size_t block = (bytes.size() + 1) / 2;
    const std::string first = deflated(bytes.substr(0, block));
    const std::string second = deflated(bytes.substr(block));
    const std::string head = header(2, p) + header(block, p) + header(bytes.size() - block, p) +
                             header(first.size(), p) + header(second.size(), p);
    return text ? base64(head) + base64(first + second) : head + first + second;
}

/// A quad as a strip, with one scalar of type T per point.
template <class T>
std::string strip_file(const char* type, const Packing& p) {
    std::string appended;
    const auto array = [&](const std::string& attributes, const std::string& bytes) {
        if (std::string_view(p.format) == "binary") {
            return "<DataArray " + attributes + " format=\"binary\">\n  " + bytes + "\n</DataArray>";
        }
        const std::string offset = std::to_string(appended.size());
        appended += bytes;
        return "<DataArray " + attributes + " format=\"appended\" offset=\"" + offset + "\"/>";
    };
    const std::string inside =
        "<PointData>" +
        array("type=\"" + std::string(type) + "\" Name=\"value\"", encoded<T>({1, 2, 3, 100}, p)) +
        "</PointData><Points>" +
        array(R"(type="Float64" NumberOfComponents="3")",
              encoded<double>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, p)) +
        "</Points><Strips>" +
        array(R"(type="Int32" Name="connectivity")", encoded<std::int32_t>({0, 1, 2, 3}, p)) +
        array(R"(type="Int64" Name="offsets")", encoded<std::int64_t>({4}, p)) + "</Strips>";
    const std::string attributes = std::string("byte_order=\"") +
                                   (p.big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
                                   (p.wide_header ? "UInt64" : "UInt32") + "\"" +
                                   (p.zlib ? " compressor=\"vtkZLibDataCompressor\"" : "");
    return test::vtp(R"(NumberOfPoints="4" NumberOfStrips="1")", inside, attributes,
                     appended.empty() ? ""
                                      : std::string("<AppendedData encoding=\"") + p.format + "\">\n _" +
                                            appended + "\n</AppendedData>");
}

class Vtp : public testing::Test {
  protected:
    void expect_strip(const std::string& bytes, const std::string& what) {
        Log log;
        const MeshData mesh = load_meshes(folder_.write("a.vtp", bytes), {}, log).at(0);
        test::expect_valid(mesh);
        EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3})) << what;
        ASSERT_EQ(mesh.scalars.size(), 1U) << what;
        EXPECT_EQ(mesh.scalars[0].values, (std::vector<float>{1, 2, 3, 100})) << what;
        EXPECT_EQ(mesh.normals[0], glm::vec3(0.0F, 0.0F, 1.0F)) << what;
    }

    std::string refusal(const std::string& bytes) {
        try {
            static_cast<void>(read_vtp(folder_.write("a.vtp", bytes)));
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            return error.what();
        }
        return "accepted";
    }

    TempFolder folder_;
};

TEST_F(Vtp, EveryPackingIsRead) {
    for (const char* format : {"binary", "raw", "base64"}) {
        for (int bits = 0; bits < 8; ++bits) {
            const Packing p{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, format};
            expect_strip(strip_file<float>("Float32", p), format + std::to_string(bits));
        }
    }
}

TEST_F(Vtp, EveryNumericTypeIsRead) {
    for (const bool big_endian : {false, true}) {
        const Packing p{big_endian, false, true, "raw"};
        expect_strip(strip_file<double>("Float64", p), "Float64");
        expect_strip(strip_file<std::int8_t>("Int8", p), "Int8");
        expect_strip(strip_file<std::uint8_t>("UInt8", p), "UInt8");
        expect_strip(strip_file<std::int16_t>("Int16", p), "Int16");
        expect_strip(strip_file<std::uint16_t>("UInt16", p), "UInt16");
        expect_strip(strip_file<std::int32_t>("Int32", p), "Int32");
        expect_strip(strip_file<std::uint32_t>("UInt32", p), "UInt32");
        expect_strip(strip_file<std::int64_t>("Int64", p), "Int64");
        expect_strip(strip_file<std::uint64_t>("UInt64", p), "UInt64");
    }
}

TEST_F(Vtp, DamageIsNamed) {
    const Packing plain{false, false, false, "raw"};
    const std::string good = strip_file<float>("Float32", plain);
    EXPECT_EQ(refusal(good), "accepted");
    EXPECT_THAT(refusal(good.substr(0, good.size() - 20)), HasSubstr("cut off"));
    std::string other = good;
    other.replace(other.find("PolyData"), 8, "ImageDat");
    EXPECT_THAT(refusal(other), HasSubstr("not PolyData"));
    EXPECT_THAT(refusal(test::vtp("", "", R"(compressor="vtkLZ4DataCompressor")")),
                HasSubstr("vtkLZ4DataCompressor"));
    EXPECT_THAT(refusal(test::vtp(R"(NumberOfPoints="9999999999")",
                                  "<Points><DataArray type=\"Float32\"/></Points>")),
                HasSubstr("are due"));
    EXPECT_THAT(
        refusal(test::vtp(
            R"(NumberOfPoints="1")",
            R"(<Points><DataArray type="Float32" NumberOfComponents="3">0 x 0</DataArray></Points>)")),
        HasSubstr("'x' is no number"));
}

TEST_F(Vtp, APackedArrayThatClaimsTheMoonIsRefused) {
    const std::string head = bytes_of(std::vector<std::uint32_t>{1, 0xFFFFFFFFU, 0, 4}) + "abcd";
    EXPECT_THAT(
        refusal(test::vtp(R"(NumberOfPoints="1")",
                          R"(<Points><DataArray type="Float32" NumberOfComponents="3" format="binary">)" +
                              base64(head) + "</DataArray></Points>",
                          R"(compressor="vtkZLibDataCompressor")")),
        HasSubstr("claims more than its bytes can hold"));
}

std::string line_file(const std::string& name) {
    // Two lines that share their first two points, as copies.
    return test::vtp(R"(NumberOfPoints="6" NumberOfLines="2")",
                     R"(<PointData><DataArray type="Float64" Name=")" + name +
                         R"(">3 2 1 3 2 -1</DataArray></PointData>)"
                         R"(<Points><DataArray type="Float32" NumberOfComponents="3">)"
                         "0 0 0  0 0 1  1 0 2  0 0 0  0 0 1  -1 0 2</DataArray></Points><Lines>"
                         R"(<DataArray type="Int64" Name="connectivity">0 1 2 3 4 5</DataArray>)"
                         R"(<DataArray type="Int64" Name="offsets">3 6</DataArray></Lines>)");
}

TEST(Centreline, LinesOfAVtpShareTheirTrunk) {
    const TempFolder folder;
    for (const char* name : {"MaximumInscribedSphereRadius", "radius"}) {
        Log log;
        const CentrelineGraph graph = load_centreline(folder.write("a.vtp", line_file(name)), log);
        ASSERT_EQ(graph.nodes.size(), 4U);
        EXPECT_EQ(graph.edges.size(), 3U);
        EXPECT_EQ(graph.nodes[0].radius_mm, 3.0);
        EXPECT_EQ(graph.nodes[3].radius_mm, 0.0);
        EXPECT_EQ(log.faults().at("centreline: radii that are negative or not finite set to 0"), 1U);
    }
}

std::string refusal(const TempFolder& folder, const char* name, const std::string& bytes) {
    Log log;
    try {
        static_cast<void>(load_centreline(folder.write(name, bytes), log));
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::file);
        return error.what();
    }
    return "accepted";
}

TEST(Centreline, ErrorsNameFileAndKey) {
    const TempFolder folder;
    EXPECT_THAT(refusal(folder, "a.vtp", line_file("width")),
                HasSubstr("neither 'MaximumInscribedSphereRadius'"));
    EXPECT_THAT(refusal(folder, "a.vtp", test::tetra_vtp()), HasSubstr("holds no lines"));
    EXPECT_THAT(refusal(folder, "a.json", "{"), HasSubstr("a.json: is no JSON"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"cm","nodes":[],"edges":[]})"),
                HasSubstr("a.json: /unit: must be"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"mm","nodes":[[0,0,0,1],[0,0,1]],"edges":[]})"),
                HasSubstr("/nodes/1: must be [x, y, z, radius]"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"mm","nodes":[[0,0,"0",1]],"edges":[]})"),
                HasSubstr("/nodes/0/2: must be a number"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"mm","nodes":[],"edges":[[0,-1]]})"),
                HasSubstr("/edges/0/1"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"mm","nodes":[]})"),
                HasSubstr("/edges: must be a list"));
    EXPECT_THAT(refusal(folder, "a.json", R"({"unit":"mm","node":[]})"), HasSubstr("/node: is unknown"));
    EXPECT_THAT(refusal(folder, "a.txt", ""), HasSubstr(".vtp and .json can"));
}

TEST(Centreline, BadEdgesAreCounted) {
    const TempFolder folder;
    Log log;
    const CentrelineGraph graph = load_centreline(
        folder.write(
            "a.json",
            R"({"unit":"mm","nodes":[[0,0,0,1],[0,0,9,2],[0,0,9,2]],"edges":[[0,1],[1,0],[1,1],[0,7]]})"),
        log);
    EXPECT_EQ(graph.nodes.size(), 3U);
    EXPECT_EQ(graph.edges.size(), 1U);
    EXPECT_EQ(log.faults().at("centreline: repeated edges and edges from a node to itself dropped"), 2U);
    EXPECT_EQ(log.faults().at("centreline: edges to nodes that are not there dropped"), 1U);
}

}  // namespace
}  // namespace viscera::io
