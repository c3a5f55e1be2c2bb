#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cstring>
#include <limits>
#include <set>

#include "engine/core/error.h"
#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"

namespace viscera::io {

namespace {

/// Collects the encoded file in memory, so that one write puts it on disk whole.
class MemoryOutput : public Imf::OStream {
  public:
    MemoryOutput() : Imf::OStream("memory") {}

    void write(const char* bytes, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (bytes_.size() < position_ + size) {
            bytes_.resize(position_ + size);
        }
        std::memcpy(bytes_.data() + position_, bytes, size);
        position_ += size;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }

    [[nodiscard]] const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
    std::size_t position_ = 0;
};

Imf::Compression to_imf(ExrCompression compression) {
    switch (compression) {
        case ExrCompression::none:
            return Imf::NO_COMPRESSION;
        case ExrCompression::zips:
            return Imf::ZIPS_COMPRESSION;
        case ExrCompression::zip:
            return Imf::ZIP_COMPRESSION;
        case ExrCompression::piz:
            return Imf::PIZ_COMPRESSION;
        case ExrCompression::dwaa:
            return Imf::DWAA_COMPRESSION;
    }
    return Imf::ZIP_COMPRESSION;
}

std::vector<std::string> channel_names(const ExrPart& part) {
    return part.channels.empty() ? default_channel_names(part.image.format) : part.channels;
}

void check(const std::filesystem::path& file, std::span<const ExrPart> parts) {
    const auto fail = [&](const ExrPart& part, const std::string& message) {
        throw Error(ErrorCode::usage, file.string(), "target '" + part.name + "': " + message);
    };
    if (parts.empty()) {
        throw Error(ErrorCode::usage, file.string(), "no targets to write");
    }
    std::set<std::string> names;
    for (const ExrPart& part : parts) {
        const Image& image = part.image;
        if (image.width <= 0 || image.height <= 0) {
            fail(part, "has no pixels");
        }
        const std::size_t pixels =
            static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
        if (image.data.size() != pixels * bytes_per_pixel(image.format)) {
            fail(part, "its bytes do not match its size and format");
        }
        const std::vector<std::string> channels = channel_names(part);
        const std::set<std::string> distinct(channels.begin(), channels.end());
        if (channels.size() != static_cast<std::size_t>(image.channels()) ||
            distinct.size() != channels.size() || distinct.contains("")) {
            fail(part, "needs " + std::to_string(image.channels()) + " different channel names");
        }
        if (parts.size() > 1 && (part.name.empty() || !names.insert(part.name).second)) {
            fail(part, "the parts of one file need names of their own");
        }
    }
}

/// OpenEXR wants one display window for all parts of a file: the one that holds every picture.
Imath::Box2i display_window(std::span<const ExrPart> parts) {
    Imath::Box2i window({0, 0}, {0, 0});
    for (const ExrPart& part : parts) {
        window.extendBy(Imath::V2i(part.image.width - 1, part.image.height - 1));
    }
    return window;
}

Imf::Header make_header(const ExrPart& part, const Imath::Box2i& display, ExrCompression compression) {
    Imf::Header header(display, Imath::Box2i({0, 0}, {part.image.width - 1, part.image.height - 1}));
    header.compression() = to_imf(compression);
    if (!part.name.empty()) {
        header.setName(part.name);
    }
    header.setType(Imf::SCANLINEIMAGE);
    const bool is_float = info(part.image.format).type == ChannelType::float32;
    for (const std::string& name : channel_names(part)) {
        header.channels().insert(name, Imf::Channel(is_float ? Imf::FLOAT : Imf::HALF));
    }
    for (const ExrAttribute& attribute : part.attributes) {
        if (const auto* text = std::get_if<std::string>(&attribute.value)) {
            header.insert(attribute.name, Imf::StringAttribute(*text));
        } else {
            header.insert(attribute.name, Imf::FloatAttribute(std::get<float>(attribute.value)));
        }
    }
    return header;
}

Image as_half(const Image& image) {
    constexpr std::array<PixelFormat, 5> half_of_channels{
        PixelFormat::r16f, PixelFormat::r16f, PixelFormat::rg16f, PixelFormat::rgba16f, PixelFormat::rgba16f};
    Image half =
        make_image(image.width, image.height, half_of_channels[static_cast<std::size_t>(image.channels())]);
    for (std::size_t i = 0; i < image.data.size(); ++i) {
        const unsigned short bits = float_to_half(static_cast<float>(image.data[i]) / 255.0F);
        std::memcpy(half.data.data() + i * sizeof bits, &bits, sizeof bits);
    }
    return half;
}

/// Slices that walk upwards in memory, since EXR's first row is our last. The image must outlive them and is
/// only read.
Imf::FrameBuffer frame_buffer(const Image& image, const std::vector<std::string>& channels) {
    const ChannelType type = info(image.format).type;
    const std::size_t pixel_bytes = bytes_per_pixel(image.format);
    const std::size_t row_bytes = pixel_bytes * static_cast<std::size_t>(image.width);
    const std::size_t last_row = row_bytes * static_cast<std::size_t>(image.height - 1);
    char* const base = const_cast<char*>(reinterpret_cast<const char*>(image.data.data())) + last_row;

    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        buffer.insert(channels[c], Imf::Slice(type == ChannelType::float32 ? Imf::FLOAT : Imf::HALF,
                                              base + c * bytes_per_channel(type), pixel_bytes,
                                              std::size_t{0} - row_bytes));
    }
    return buffer;
}

/// `file` is an Imf::OutputFile or an Imf::OutputPart.
template <class File>
void write_pixels(File& file, const ExrPart& part) {
    const bool convert = info(part.image.format).type == ChannelType::unorm8;
    const Image converted = convert ? as_half(part.image) : Image{};
    file.setFrameBuffer(frame_buffer(convert ? converted : part.image, channel_names(part)));
    file.writePixels(part.image.height);
}

void encode_exr(Imf::OStream& stream, std::span<const ExrPart> parts, ExrCompression compression) {
    const Imath::Box2i display = display_window(parts);
    if (parts.size() == 1) {
        Imf::OutputFile file(stream, make_header(parts[0], display, compression));
        write_pixels(file, parts[0]);
        return;
    }
    std::vector<Imf::Header> headers;
    headers.reserve(parts.size());
    for (const ExrPart& part : parts) {
        headers.push_back(make_header(part, display, compression));
    }
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::OutputPart part(file, static_cast<int>(i));
        write_pixels(part, parts[i]);
    }
}

}  // namespace

std::span<const std::string_view> choice_names(ExrCompression) {
    static constexpr std::array<std::string_view, 5> names{"none", "zips", "zip", "piz", "dwaa"};
    return names;
}

void write_exr(const std::filesystem::path& file, std::span<const ExrPart> parts,
               ExrCompression compression) {
    check(file, parts);
    MemoryOutput stream;
    try {
        encode_exr(stream, parts, compression);
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("cannot be encoded: ") + error.what());
    }
    write_file(file, stream.bytes());
}

}  // namespace viscera::io
