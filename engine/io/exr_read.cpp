#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/core/size_text.h"
#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"

namespace viscera::io {

namespace {

class MemoryInput : public Imf::IStream {
  public:
    explicit MemoryInput(const std::string& bytes) : Imf::IStream("memory"), bytes_(bytes) {}

    bool read(char* out, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (count < 0 || position_ > bytes_.size() || size > bytes_.size() - position_) {
            throw std::runtime_error("it ends too early");
        }
        std::memcpy(out, bytes_.data() + position_, size);
        position_ += size;
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

  private:
    const std::string& bytes_;
    std::size_t position_ = 0;
};

/// Channels that become one picture.
struct Group {
    std::string suffix;  ///< of the part's name: "", ".layer", or ".channel"
    std::vector<std::string>
        channels;  ///< as the file names them, in the picture's order; "" = filled with 1
    PixelFormat format = PixelFormat::r16f;
};

PixelFormat format_of(std::size_t channels, bool half) {
    switch (channels) {
        case 1:
            return half ? PixelFormat::r16f : PixelFormat::r32f;
        case 2:
            return half ? PixelFormat::rg16f : PixelFormat::rg32f;
        default:
            return half ? PixelFormat::rgba16f : PixelFormat::rgba32f;
    }
}

/// Takes the named channels of a layer out of `left` into one group, if those that it cannot do without are
/// there.
void take_group(std::map<std::string, Imf::PixelType>& left, const std::string& layer,
                const std::vector<std::string>& names, std::vector<Group>& groups) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    const std::size_t needed = std::min<std::size_t>(names.size(), 3);  // of R, G, B, A the A may be missing
    bool half = true;
    Group group{layer.empty() ? "" : "." + layer, {}, PixelFormat::r16f};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto found = left.find(prefix + names[i]);
        if (found == left.end() && i < needed) {
            return;
        }
        half = half && (found == left.end() || found->second == Imf::HALF);
        group.channels.push_back(found == left.end() ? "" : found->first);
    }
    for (const std::string& name : group.channels) {
        left.erase(name);
    }
    group.format = format_of(names.size(), half);
    groups.push_back(std::move(group));
}

std::vector<Group> group_channels(const Imf::ChannelList& list) {
    std::map<std::string, Imf::PixelType> left;
    std::vector<std::string> layers;
    for (auto i = list.begin(); i != list.end(); ++i) {
        const std::string name = i.name();
        if (i.channel().xSampling != 1 || i.channel().ySampling != 1) {
            throw std::runtime_error("channel '" + name + "' is subsampled, which is not supported");
        }
        left.emplace(name, i.channel().type);
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        if (std::ranges::find(layers, layer) == layers.end()) {
            layers.push_back(layer);
        }
    }
    std::vector<Group> groups;
    for (const std::string& layer : layers) {
        take_group(left, layer, {"R", "G", "B", "A"}, groups);
        take_group(left, layer, {"R", "G"}, groups);
    }
    const bool alone = groups.empty() && left.size() == 1;
    for (const auto& [name, type] : left) {
        const bool depth = type == Imf::FLOAT && (name == "Z" || name.ends_with(".Z"));
        groups.push_back({alone ? "" : "." + name,
                          {name},
                          depth ? PixelFormat::depth32f : format_of(1, type == Imf::HALF)});
    }
    return groups;
}

std::vector<ExrAttribute> read_attributes(const Imf::Header& header) {
    std::vector<ExrAttribute> attributes;
    for (auto i = header.begin(); i != header.end(); ++i) {
        const std::string name = i.name();
        const Imf::Attribute& attribute = i.attribute();
        if (name == "name" || name == "type" || name == "pixelAspectRatio" || name == "screenWindowWidth" ||
            name == "chunkCount" || name == "version") {
            continue;
        }
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
            attributes.push_back({name, text->value()});
        } else if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&attribute)) {
            attributes.push_back({name, number->value()});
        } else if (const auto* precise = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) {
            attributes.push_back({name, static_cast<float>(precise->value())});
        } else if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&attribute)) {
            attributes.push_back({name, static_cast<float>(whole->value())});
        }
    }
    return attributes;
}

/// The word for a compression, in the order of OpenEXR's enumeration.
std::string compression_name(Imf::Compression compression) {
    constexpr std::array<const char*, 10> names{"none",  "rle", "zips", "zip",  "piz",
                                                "pxr24", "b44", "b44a", "dwaa", "dwab"};
    const auto index = static_cast<std::size_t>(compression);
    return index < names.size() ? names[index] : "unknown";
}

/// A damaged header can claim any size; what the file cannot possibly hold is refused before it is allocated.
void check_size(std::int64_t width, std::int64_t height, std::size_t channels, std::size_t file_bytes) {
    constexpr double always_allowed = 256.0 * 1024 * 1024;
    constexpr double best_compression = 4096.0;
    const double bytes = static_cast<double>(width) * static_cast<double>(height) *
                         static_cast<double>(channels) * sizeof(float);
    if (width <= 0 || height <= 0 || width > (1 << 20) || height > (1 << 20) ||
        bytes > std::max(always_allowed, best_compression * static_cast<double>(file_bytes))) {
        throw std::runtime_error("it claims " + size_text({width, height}) +
                                 " pixels, more than its bytes can hold");
    }
}

void read_part(Imf::MultiPartInputFile& file, int index, std::size_t file_bytes, std::vector<ExrPart>& out) {
    const Imf::Header& header = file.header(index);
    if (header.hasType() && Imf::isDeepData(header.type())) {
        throw std::runtime_error("it holds deep data, which is not supported");
    }
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    const std::vector<Group> groups = group_channels(header.channels());
    check_size(width, height, groups.size() * 4, file_bytes);

    const std::string name = header.hasName() ? header.name() : "";
    const std::vector<ExrAttribute> attributes = read_attributes(header);
    const std::string compression = compression_name(header.compression());
    const std::size_t first = out.size();
    for (const Group& group : groups) {
        out.push_back({name + group.suffix,
                       make_image(static_cast<int>(width), static_cast<int>(height), group.format),
                       group.channels, attributes, compression});
        std::ranges::replace(out.back().channels, "", "A");
    }

    Imf::FrameBuffer buffer;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Image& image = out[first + g].image;
        const ChannelType type = info(image.format).type;
        const auto pixel_bytes = static_cast<std::ptrdiff_t>(bytes_per_pixel(image.format));
        const std::ptrdiff_t row_bytes = pixel_bytes * image.width;
        // Where the pixel (0, 0) of the file's own coordinates would stand: the first row of the window is
        // our last.
        const std::ptrdiff_t origin =
            row_bytes * (image.height - 1) + row_bytes * window.min.y - pixel_bytes * window.min.x;
        for (std::size_t c = 0; c < groups[g].channels.size(); ++c) {
            const std::ptrdiff_t channel = static_cast<std::ptrdiff_t>(c * bytes_per_channel(type));
            const auto base = reinterpret_cast<std::uintptr_t>(image.data.data());
            char* const pointer =
                reinterpret_cast<char*>(base + static_cast<std::uintptr_t>(origin + channel));
            const std::string& channel_name = groups[g].channels[c];
            // A name that the file does not have makes OpenEXR fill the slice with the given 1.
            buffer.insert(channel_name.empty() ? "viscera fill " + std::to_string(g) : channel_name,
                          Imf::Slice(type == ChannelType::float32 ? Imf::FLOAT : Imf::HALF, pointer,
                                     static_cast<std::size_t>(pixel_bytes),
                                     static_cast<std::size_t>(-row_bytes), 1, 1, 1.0));
        }
    }
    Imf::InputPart part(file, index);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
}

}  // namespace

std::vector<ExrPart> read_exr(const std::filesystem::path& file) {
    const std::string bytes = read_file(file);
    std::vector<ExrPart> parts;
    try {
        MemoryInput stream(bytes);
        Imf::MultiPartInputFile input(stream);
        for (int i = 0; i < input.parts(); ++i) {
            read_part(input, i, bytes.size(), parts);
        }
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable EXR file: ") + error.what());
    }
    return parts;
}

}  // namespace viscera::io
