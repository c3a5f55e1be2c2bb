#include "assets/generate/write_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <half.h>

#include <cmath>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace viscera::assets {
namespace {

/// Rounded to 0.1 um, so that files stay short and readable.
double rounded(double value) {
    return std::round(value * 1e4) / 1e4;
}

nlohmann::ordered_json vector_of(const glm::dvec3& v) {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    std::error_code ignored;  // the stream reports a folder that could not be made
    std::filesystem::create_directories(path.parent_path(), ignored);
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
        throw std::runtime_error(path.string() + ": cannot be written");
    }
}

void write_centreline(const CentrelineGraph& graph, const std::filesystem::path& path) {
    // One node or edge per line: nlohmann's own layouts are either one line or one line per number.
    std::string text = "{\"unit\": \"mm\",\n\"nodes\": [\n";
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        nlohmann::ordered_json row = vector_of(graph.nodes[i].position_mm);
        row.push_back(rounded(graph.nodes[i].radius_mm));
        text += row.dump() + (i + 1 < graph.nodes.size() ? ",\n" : "],\n\"edges\": [\n");
    }
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
        text += nlohmann::ordered_json({graph.edges[i].a, graph.edges[i].b}).dump();
        text += i + 1 < graph.edges.size() ? ",\n" : "]}\n";
    }
    write_file(path, text);
}

void write_landmarks(const CoronaryLandmarks& landmarks, const std::filesystem::path& path) {
    nlohmann::ordered_json json;
    json["unit"] = "mm";
    json["ostium"] = vector_of(landmarks.ostium_mm);
    json["into_root"] = vector_of(landmarks.into_root_mm);
    json["lad_middle"] = vector_of(landmarks.lad_middle_mm);
    json["lad_outward"] = vector_of(landmarks.lad_outward_mm);
    json["lad_middle_radius"] = rounded(landmarks.lad_middle_radius_mm);
    write_file(path, json.dump(2) + "\n");
}

void write_exr(const GrayImage& image, const std::filesystem::path& path) {
    std::error_code ignored;  // OpenEXR reports a folder that could not be made
    std::filesystem::create_directories(path.parent_path(), ignored);
    try {
        std::vector<half> pixels(image.pixels.begin(), image.pixels.end());
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        header.channels().insert("Y", Imf::Channel(Imf::HALF));
        Imf::FrameBuffer frame;
        frame.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(pixels.data()), sizeof(half),
                                     sizeof(half) * static_cast<std::size_t>(image.width)));
        Imf::OutputFile file(path.string().c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(image.height);
    } catch (const std::exception& failure) {
        throw std::runtime_error(path.string() + ": " + failure.what());
    }
}

}  // namespace viscera::assets
