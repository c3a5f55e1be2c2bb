#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/png.h"
#include "engine/io/tiff.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"

namespace viscera::io {

namespace {

bool is_picture(const std::filesystem::path& file) {
    static constexpr std::array<std::string_view, 5> endings{".png", ".jpg", ".jpeg", ".tif", ".tiff"};
    return std::ranges::find(endings, lower_extension(file)) != endings.end() &&
           !file.filename().string().starts_with('.');
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Takes a run of digits without leading zeros, or one other character.
std::string_view take_piece(std::string_view& text) {
    if (!is_digit(text.front())) {
        const std::string_view piece = text.substr(0, 1);
        text.remove_prefix(1);
        return piece;
    }
    const std::size_t end = std::min(text.size(), text.find_first_not_of("0123456789"));
    std::string_view piece = text.substr(0, end);
    text.remove_prefix(end);
    piece.remove_prefix(std::min(piece.find_first_not_of('0'), piece.size() - 1));
    return piece;
}

/// slice2 before slice10.
bool naturally_before(const std::filesystem::path& left, const std::filesystem::path& right) {
    const std::string a = left.filename().string();
    const std::string b = right.filename().string();
    std::string_view x = a;
    std::string_view y = b;
    while (!x.empty() && !y.empty()) {
        const bool numbers = is_digit(x.front()) && is_digit(y.front());
        const std::string_view p = take_piece(x);
        const std::string_view q = take_piece(y);
        if (numbers && p.size() != q.size()) {
            return p.size() < q.size();
        }
        if (p != q) {
            return p < q;
        }
    }
    return x.empty() != y.empty() ? x.empty() : a < b;
}

/// A slice with its top row first.
struct Picture {
    glm::ivec2 size{};
    FileScalar type = FileScalar::u8;
    int channels = 1;
    std::vector<std::byte> bytes;

    bool operator==(const Picture& other) const {
        return size == other.size && type == other.type && channels == other.channels;
    }
};

Picture of_image(const Image& image) {
    const bool deep = info(image.format).type == ChannelType::float32;
    Picture picture{
        {image.width, image.height}, deep ? FileScalar::u16 : FileScalar::u8, image.channels(), {}};
    const std::size_t row = image.data.size() / static_cast<std::size_t>(std::max(image.height, 1));
    for (std::size_t y = static_cast<std::size_t>(image.height); y-- > 0;) {
        const auto first = image.data.begin() + static_cast<std::ptrdiff_t>(y * row);
        picture.bytes.insert(picture.bytes.end(), first, first + static_cast<std::ptrdiff_t>(row));
    }
    if (deep) {
        // n / 65535 back to n, in place: the numbers shrink.
        const std::size_t count = picture.bytes.size() / sizeof(float);
        for (std::size_t i = 0; i < count; ++i) {
            float value = 0.0F;
            std::memcpy(&value, picture.bytes.data() + i * sizeof value, sizeof value);
            const auto number = static_cast<std::uint16_t>(std::lround(value * 65535.0F));
            std::memcpy(picture.bytes.data() + i * sizeof number, &number, sizeof number);
        }
        picture.bytes.resize(count * sizeof(std::uint16_t));
    }
    return picture;
}

/// Whether a picture of three channels has the same in each.
bool is_grey(const Picture& picture) {
    const std::size_t width = bytes_of(picture.type);
    const std::size_t step = width * static_cast<std::size_t>(picture.channels);
    const std::byte* at = picture.bytes.data();
    for (std::size_t i = 0; i + step <= picture.bytes.size(); i += step, at += step) {
        if (std::memcmp(at, at + width, width) != 0 || std::memcmp(at, at + 2 * width, width) != 0) {
            return false;
        }
    }
    return true;
}

Picture first_channels(const Picture& picture, int channels) {
    Picture result{picture.size, picture.type, channels, {}};
    const std::size_t width = bytes_of(picture.type);
    const std::size_t step = width * static_cast<std::size_t>(picture.channels);
    const std::size_t kept = width * static_cast<std::size_t>(channels);
    result.bytes.resize(picture.bytes.size() / step * kept);
    for (std::size_t i = 0; i * step < picture.bytes.size(); ++i) {
        std::memcpy(result.bytes.data() + i * kept, picture.bytes.data() + i * step, kept);
    }
    return result;
}

/// Alpha is no tissue: a colour slice has three channels.
Picture read_picture(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    Picture picture;
    if (extension == ".tif" || extension == ".tiff") {
        TiffPicture tiff = read_tiff(file);
        picture = {{tiff.width, tiff.height},
                   tiff.bits == 8 ? FileScalar::u8 : FileScalar::u16,
                   tiff.channels,
                   std::move(tiff.bytes)};
    } else {
        picture = of_image(read_image(file));
    }
    const bool has_alpha = picture.channels == 2 || picture.channels == 4;
    return has_alpha ? first_channels(picture, picture.channels - 1) : picture;
}

std::vector<std::filesystem::path> pictures_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        if (entry.is_regular_file(ignored) && is_picture(entry.path())) {
            files.push_back(entry.path());
        }
    }
    std::ranges::sort(files, naturally_before);
    return files;
}

}  // namespace

bool has_slices(const std::filesystem::path& folder) {
    return !pictures_of(folder).empty();
}

Volume read_slices(const Reading& reading) {
    const std::vector<std::filesystem::path> files = pictures_of(reading.file);
    const auto load = [&](std::size_t index) {
        try {
            return read_picture(files.at(index));
        } catch (const Error& error) {
            reading.fail("'" + files[index].filename().string() + "' " + std::string(error.message()));
        }
    };
    Picture first = load(0);
    // Colour files hold grey more often than colour, and a blank slice of a coloured stack is grey, too.
    bool all_grey = first.channels == 3;
    for (std::size_t i = 0; all_grey && i < files.size(); ++i) {
        const Picture picture = load(i);
        all_grey = picture.channels == 1 || is_grey(picture);
    }
    const auto load_kept = [&](std::size_t index) {
        Picture picture = load(index);
        return all_grey ? first_channels(picture, 1) : picture;
    };
    first = load_kept(0);
    VolumeHead head;
    head.volume.grid.dims = {first.size, static_cast<int>(files.size())};
    head.volume.channels = first.channels;
    head.type = first.type;
    reading.log.info(reading.file.string() + ": pictures hold no spacing; voxels are taken as 1 mm wide");
    const ReadBytes read = read_slice_by_slice([&](std::size_t index) {
        Picture picture = load_kept(index);
        if (!(picture == first)) {
            reading.fail("'" + files[index].filename().string() +
                         "' differs in size, type or colour from the first slice");
        }
        return std::move(picture.bytes);
    });
    return read_voxels(head, read, reading);
}

}  // namespace viscera::io
