#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/core/image.h"

namespace viscera::io {

/// How the pixels of an EXR file are packed. All but dwaa keep every bit; dwaa loses precision in the
/// channels R, G, B and Y.
enum class ExrCompression { none, zips, zip, piz, dwaa };
[[nodiscard]] std::span<const std::string_view> choice_names(ExrCompression compression);

/// One entry of an EXR header beyond those that the format itself needs.
struct ExrAttribute {
    std::string name;  ///< "viscera:scene_hash"
    std::variant<std::string, float> value;
    bool operator==(const ExrAttribute&) const = default;
};

/// One picture of an EXR file: a target with its name and what the header says of it.
struct ExrPart {
    std::string name;                   ///< the target's: "contrast.main"
    Image image;                        ///< bottom row first, as every Image
    std::vector<std::string> channels;  ///< one name per channel; empty: default_channel_names()
    std::vector<ExrAttribute> attributes;
    std::string compression{};  ///< set by read_exr(): OpenEXR's word for how the part was packed: "zip"
};

/// Writes the parts as one EXR file: one part as an ordinary file, several as a multi-part file. Half and
/// float are stored as they are, 8-bit channels as half (n/255 rounded to half, which gives n back exactly),
/// rows turned to EXR's order, top row first. The file appears whole or not at all. Throws Error(file) when
/// it cannot be written, Error(usage) for no parts, empty pictures, a wrong number of channel names, or names
/// that are empty or doubled where they must be told apart.
void write_exr(const std::filesystem::path& file, std::span<const ExrPart> parts,
               ExrCompression compression = ExrCompression::zip);

/// Reads every part and channel. Channels of a layer that are R, G, B with or without A become one picture of
/// four channels (A = 1 where there is none), R with G one of two, Z in float a depth; every other channel
/// becomes a picture of its own, named "part.channel". Half stays half; float and integer become float.
/// Throws Error(file) for a damaged file, for deep data, and for one that claims to be much larger than its
/// bytes can hold.
[[nodiscard]] std::vector<ExrPart> read_exr(const std::filesystem::path& file);

}  // namespace viscera::io
