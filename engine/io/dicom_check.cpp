#include "engine/io/dicom_check.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

namespace viscera::io {

namespace {

constexpr std::uint32_t undefined_length = 0xffffffffU;
constexpr std::uint32_t item = 0xfffee000U;
constexpr std::uint32_t item_end = 0xfffee00dU;
constexpr std::uint32_t sequence_end = 0xfffee0ddU;
constexpr std::uint32_t samples_per_pixel = 0x00280002U;
constexpr std::uint32_t frames = 0x00280008U;
constexpr std::uint32_t rows = 0x00280010U;
constexpr std::uint32_t columns = 0x00280011U;
constexpr std::uint32_t bits_allocated = 0x00280100U;
constexpr std::uint32_t pixel_data = 0x7fe00010U;

struct DataElement {
    std::uint32_t tag = 0;
    std::string_view type;  ///< empty where the file does not say
    std::uint32_t length = 0;
};

/// What GDCM takes without a look at its type.
struct Layout {
    std::uint32_t tag;
    std::string_view type;
    bool is_single = true;
};
constexpr std::array<Layout, 30> layout{
    {{0x00080008U, "CS"}, {0x00080016U, "UI"}, {0x00080060U, "CS"},        {0x00180050U, "DS"},
     {0x00180088U, "DS"}, {0x00181164U, "DS"}, {0x00200013U, "IS"},        {0x00200032U, "DS"},
     {0x00200037U, "DS"}, {0x00280002U, "US"}, {0x00280004U, "CS"},        {0x00280006U, "US"},
     {0x00280008U, "IS"}, {0x00280009U, "AT"}, {0x00280010U, "US"},        {0x00280011U, "US"},
     {0x00280030U, "DS"}, {0x00280034U, "IS"}, {0x00280100U, "US"},        {0x00280101U, "US"},
     {0x00280102U, "US"}, {0x00280103U, "US"}, {0x00281050U, "DS"},        {0x00281051U, "DS"},
     {0x00281052U, "DS"}, {0x00281053U, "DS"}, {0x00281101U, "US", false}, {0x00282110U, "CS"},
     {0x3004000cU, "DS"}, {0x52009229U, "SQ"}}};

[[noreturn]] void fail(const std::string& message) {
    throw std::runtime_error(message);
}

/// A number of the file's byte order.
template <class T>
T in_order(const char* bytes, std::endian order) {
    std::array<char, sizeof(T)> turned{};
    std::copy_n(bytes, sizeof(T), turned.begin());
    if (order != std::endian::native) {
        std::ranges::reverse(turned);
    }
    return std::bit_cast<T>(turned);
}

/// What a stream of raw deflate holds. A few packed bytes may ask for a thousand times as many.
std::string inflated(std::string_view packed, std::uint64_t most_bytes) {
    struct Stream : z_stream {
        Stream() : z_stream{} {
            if (inflateInit2(this, -MAX_WBITS) != Z_OK) {
                throw std::runtime_error("zlib does not start");
            }
        }
        Stream(const Stream&) = delete;
        Stream& operator=(const Stream&) = delete;
        ~Stream() { inflateEnd(this); }
    } stream;
    constexpr std::size_t step = std::numeric_limits<uInt>::max();
    std::string bytes;
    std::size_t done = 0;
    for (int status = Z_OK; status != Z_STREAM_END;) {
        if (done == bytes.size()) {
            if (done >= most_bytes) {
                throw std::length_error("unpacks to more than the " + std::to_string(most_bytes >> 20U) +
                                        " MiB of memory that there are");
            }
            bytes.resize(std::min<std::uint64_t>(most_bytes, 2 * (done + packed.size())));
        }
        // zlib counts in 32 bits and reads through a pointer that is not const.
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
        stream.avail_in = static_cast<uInt>(std::min(packed.size(), step));
        stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
        stream.avail_out = static_cast<uInt>(std::min(bytes.size() - done, step));
        const uInt taken = stream.avail_in;
        const uInt room = stream.avail_out;
        status = inflate(&stream, Z_NO_FLUSH);
        packed.remove_prefix(taken - stream.avail_in);
        done += room - stream.avail_out;
        if (status != Z_OK && status != Z_STREAM_END) {
            fail(status == Z_BUF_ERROR ? "is truncated: its deflated elements end too early"
                                       : "its deflated elements are damaged");
        }
    }
    bytes.resize(done);
    return bytes;
}

class Walk {
  public:
    explicit Walk(std::string_view bytes) : rest_(bytes) {}

    void file(std::uint64_t most_bytes) {
        constexpr std::size_t preamble = 132;
        if (rest_.size() < preamble || rest_.substr(128, 4) != "DICM") {
            fail("has no DICOM preamble");
        }
        rest_.remove_prefix(preamble);
        meta();
        set_syntax();
        std::string unpacked;
        if (syntax_ == "1.2.840.10008.1.2.1.99") {
            unpacked = inflated(rest_, most_bytes);
            rest_ = unpacked;
        }
        if (rest_.size() < 8 || peek_group() <= 2) {
            fail("its file meta information does not end where it should");
        }
        elements(rest_, 0);
    }

  private:
    /// The group that tells how the others are stored; its first element is its length.
    void meta() {
        const DataElement first = next();
        if (first.tag != 0x00020000U || first.type != "UL" || first.length != 4) {
            fail("its file meta information has no length");
        }
        Walk group = *this;
        group.rest_ = rest_.substr(4, number<std::uint32_t>(0));
        static_cast<void>(take(4 + group.rest_.size()));
        for (std::uint32_t last = first.tag; !group.rest_.empty();) {
            const DataElement element = group.next();
            if (element.tag >> 16U != 2 || element.tag <= last) {
                fail("its file meta information is damaged");
            }
            last = element.tag;
            const std::string_view value = group.take(element.length);
            group.check_value(element, value);
            if (element.tag == 0x00020010U) {
                syntax_ =
                    value.substr(0, std::min(value.find_first_of(std::string_view("\0 ", 2)), value.size()));
            }
        }
    }

    void set_syntax() {
        if (!syntax_.starts_with("1.2.840.10008.1.2")) {
            fail("TransferSyntaxUID is missing or unknown");
        }
        explicit_ = syntax_ != "1.2.840.10008.1.2";
        if (syntax_ == "1.2.840.10008.1.2.2") {
            order_ = std::endian::big;
        }
    }

    template <class T>
    [[nodiscard]] T number(std::size_t at) const {
        if (rest_.size() < at + sizeof(T)) {
            fail("is truncated within an element");
        }
        return in_order<T>(rest_.data() + at, order_);
    }
    [[nodiscard]] std::uint32_t peek_group() const { return number<std::uint16_t>(0); }

    [[nodiscard]] std::string_view take(std::size_t size) {
        if (size > rest_.size()) {
            fail("is truncated: an element is longer than the file");
        }
        const std::string_view value = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return value;
    }

    [[nodiscard]] DataElement next() {
        DataElement element;
        element.tag = peek_group() << 16U | number<std::uint16_t>(2);
        constexpr std::uint32_t delimiters = 0xfffeU;
        if (!explicit_ || element.tag >> 16U == delimiters) {
            element.length = number<std::uint32_t>(4);
            static_cast<void>(take(8));
            return element;
        }
        static constexpr std::string_view types =
            "AE AS AT CS DA DS DT FD FL IS LO LT OB OD OF OL OV OW PN SH SL SQ SS ST SV TM UC UI UL UN UR US "
            "UT UV";
        static constexpr std::string_view wide = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
        static_cast<void>(number<std::uint64_t>(0));
        element.type = rest_.substr(4, 2);
        const std::size_t known = types.find(element.type);
        if (known == std::string_view::npos || known % 3 != 0) {
            fail("holds an element of no known type");
        }
        const std::size_t is_wide = wide.find(element.type);
        if (is_wide != std::string_view::npos && is_wide % 3 == 0) {
            element.length = number<std::uint32_t>(8);
            static_cast<void>(take(12));
        } else {
            element.length = number<std::uint16_t>(6);
            static_cast<void>(take(8));
        }
        return element;
    }

    /// Numbers have whole values; some that lay out the picture have one.
    void check_value(const DataElement& element, std::string_view value) const {
        struct Width {
            std::string_view type;
            std::size_t bytes;
        };
        static constexpr std::array<Width, 8> widths{
            {{"US", 2}, {"SS", 2}, {"UL", 4}, {"SL", 4}, {"FL", 4}, {"FD", 8}, {"AT", 4}, {"OW", 2}}};
        const auto* const width = std::ranges::find(widths, element.type, &Width::type);
        if (width != widths.end() && value.size() % width->bytes != 0) {
            fail("an element ends within a number");
        }
        const auto* const known = std::ranges::find(layout, element.tag, &Layout::tag);
        if (known == layout.end()) {
            return;
        }
        if (explicit_ && element.type != known->type) {
            fail("an element that lays out the image has a wrong type");
        }
        if (known->type == "US" && known->is_single && value.size() != 2) {
            fail("an element that lays out the image is not one number");
        }
        if (element.tag == samples_per_pixel && (word(value) < 1 || word(value) > 4)) {
            fail("SamplesPerPixel " + std::to_string(word(value)) + " is not 1 to 4");
        }
    }

    [[nodiscard]] std::uint16_t word(std::string_view value) const {
        return value.size() < 2 ? std::uint16_t{0} : in_order<std::uint16_t>(value.data(), order_);
    }

    void note_size(const DataElement& element, std::string_view value) {
        if (element.tag == frames) {
            const auto first = std::min(value.find_first_not_of(' '), value.size());
            std::from_chars(value.data() + first, value.data() + value.size(), frames_);
        } else if (element.tag == rows || element.tag == columns) {
            pixels_ *= word(value);
        } else if (element.tag == samples_per_pixel) {
            samples_ = word(value);
        } else if (element.tag == bits_allocated) {
            bits_ = word(value);
        }
    }

    /// GDCM writes as many bytes as the element holds, however small the picture that it names.
    void check_pixels(std::uint32_t length) const {
        const std::uint64_t bytes = pixels_ * samples_ * std::max(frames_, 1U) * bits_ / 8;
        if (bytes == 0 || (length != bytes && length != bytes + bytes % 2)) {
            fail("PixelData has " + std::to_string(length) + " bytes, the sizes of the image ask for " +
                 std::to_string(bytes));
        }
    }

    /// Elements up to the end of `inside`, which is what is left of the file or an item of known length.
    void elements(std::string_view inside, int depth) {
        constexpr int most_depth = 16;
        if (depth > most_depth) {
            fail("nests its sequences too deep");
        }
        Walk walk = *this;
        walk.rest_ = inside;
        std::uint32_t last = 0;
        while (!walk.rest_.empty()) {
            const DataElement element = walk.next();
            if (element.tag >> 16U == item >> 16U) {
                fail("holds an item outside of a sequence");
            }
            if (element.tag <= last) {
                fail("its elements are not in order");
            }
            last = element.tag;
            walk.value(element, depth);
        }
    }

    void value(const DataElement& element, int depth) {
        if (element.length == undefined_length) {
            if (element.tag == pixel_data) {
                fragments();
            } else if (element.type == "SQ" || element.type == "UN" || element.type.empty()) {
                items(depth);
            } else {
                fail("an element has no length");
            }
            return;
        }
        const std::string_view bytes = take(element.length);
        check_value(element, bytes);
        if (depth == 0) {
            note_size(element, bytes);
        }
        if (depth == 0 && element.tag == pixel_data) {
            check_pixels(element.length);
        }
        if (element.type == "SQ") {
            Walk walk = *this;
            walk.rest_ = bytes;
            while (!walk.rest_.empty()) {
                walk.one_item(walk.next(), depth);
            }
        }
    }

    void one_item(const DataElement& element, int depth) {
        if (element.tag != item) {
            fail("a sequence holds something else than items");
        }
        if (element.length != undefined_length) {
            elements(take(element.length), depth + 1);
            return;
        }
        for (DataElement inner = next(); inner.tag != item_end; inner = next()) {
            value(inner, depth + 1);
        }
    }

    void items(int depth) {
        constexpr int most_depth = 16;
        if (depth > most_depth) {
            fail("nests its sequences too deep");
        }
        for (DataElement element = next(); element.tag != sequence_end; element = next()) {
            one_item(element, depth + 1);
        }
    }

    /// Packed pictures: pieces without elements of their own.
    void fragments() {
        for (DataElement element = next(); element.tag != sequence_end; element = next()) {
            if (element.tag != item || element.length == undefined_length) {
                fail("its packed pixels are damaged");
            }
            static_cast<void>(take(element.length));
        }
    }

    std::string_view rest_;
    std::string_view syntax_;
    bool explicit_ = true;
    std::endian order_ = std::endian::little;  ///< the file meta information always is
    std::uint64_t pixels_ = 1;                 ///< of one frame
    std::uint64_t samples_ = 1;
    std::uint64_t bits_ = 0;  ///< of a sample
    unsigned int frames_ = 1;
};

}  // namespace

void check_dicom(std::string_view bytes, std::uint64_t most_bytes) {
    Walk(bytes).file(most_bytes);
}

}  // namespace viscera::io
