#include "engine/io/vtp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <set>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/vtk_data.h"

namespace viscera::io {

namespace {

/// The bytes behind the '_' of AppendedData, cut out of the text since raw ones are no XML.
struct Appended {
    std::string bytes;
    bool base64 = false;
    std::set<std::size_t> offsets;  ///< where each array begins
};

/// Cuts the appended bytes out of `text` and leaves well-formed XML.
Appended cut_appended(std::string& text) {
    Appended appended;
    const std::size_t element = text.find("<AppendedData");
    if (element == std::string::npos) {
        return appended;
    }
    const std::size_t open = text.find('>', element);
    const std::size_t mark = open == std::string::npos ? open : text.find('_', open);
    const std::size_t close = text.rfind("</AppendedData>");
    if (mark == std::string::npos || close == std::string::npos || close < mark) {
        throw std::runtime_error("its appended data are cut off");
    }
    appended.base64 =
        std::string_view(text).substr(element, open - element).find("base64") != std::string::npos;
    appended.bytes = text.substr(mark + 1, close - mark - 1);
    text.erase(open + 1, close - open - 1);
    return appended;
}

class Reader {
  public:
    explicit Reader(std::string text) : appended_(cut_appended(text)) {
        const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
        if (!parsed) {
            throw std::runtime_error(std::string(parsed.description()) + " at byte " +
                                     std::to_string(parsed.offset));
        }
        read_root();
    }

    [[nodiscard]] std::vector<VtpPiece> pieces() const {
        std::vector<VtpPiece> pieces;
        for (const pugi::xml_node piece : root_.child("PolyData").children("Piece")) {
            pieces.push_back(read_piece(piece));
        }
        return pieces;
    }

  private:
    void read_root() {
        root_ = document_.child("VTKFile");
        const std::string_view type = root_.attribute("type").value();
        if (type != "PolyData") {
            throw std::runtime_error("its VTKFile type is '" + std::string(type) + "', not PolyData");
        }
        const std::string_view packing = root_.attribute("compressor").value();
        if (!packing.empty() && packing != "vtkZLibDataCompressor") {
            throw std::runtime_error("its arrays are packed with " + std::string(packing) +
                                     "; only vtkZLibDataCompressor is read");
        }
        encoding_.zlib = !packing.empty();
        encoding_.big_endian = std::string_view(root_.attribute("byte_order").value()) == "BigEndian";
        encoding_.header_64bit = std::string_view(root_.attribute("header_type").value()) == "UInt64";
        for (const pugi::xpath_node found : root_.select_nodes(".//DataArray[@format='appended']")) {
            appended_.offsets.insert(found.node().attribute("offset").as_ullong());
        }
    }

    [[nodiscard]] std::vector<double> read_appended(const pugi::xml_node& array, const char* type) const {
        const std::size_t offset = array.attribute("offset").as_ullong();
        if (offset >= appended_.bytes.size()) {
            throw std::runtime_error("an array begins beyond the appended data");
        }
        const std::string_view bytes = std::string_view(appended_.bytes).substr(offset);
        if (!appended_.base64) {
            return decode_vtk_array(bytes, type, encoding_);
        }
        const auto next = appended_.offsets.upper_bound(offset);
        const std::size_t length = next == appended_.offsets.end() ? bytes.size() : *next - offset;
        return decode_vtk_array(decode_base64(bytes.substr(0, length)), type, encoding_);
    }

    [[nodiscard]] std::vector<double> read_values(const pugi::xml_node& array) const {
        const std::string_view format = array.attribute("format").value();
        const char* const type = array.attribute("type").value();
        if (format == "appended") {
            return read_appended(array, type);
        }
        if (format == "binary") {
            return decode_vtk_array(decode_base64(array.child_value()), type, encoding_);
        }
        if (format == "ascii" || format.empty()) {
            return parse_vtk_text(array.child_value());
        }
        throw std::runtime_error("array format '" + std::string(format) + "' is unknown");
    }

    /// An array of `tuples` tuples. What it lacks or has too much is an error that names it.
    [[nodiscard]] VtkArray read_array(const pugi::xml_node& array, std::size_t tuples) const {
        VtkArray result;
        result.name = array.attribute("Name").value();
        result.components = array.attribute("NumberOfComponents").as_uint(1);
        try {
            result.values = read_values(array);
            if (result.components == 0 || result.values.size() % result.components != 0 ||
                result.values.size() / result.components != tuples) {
                throw std::runtime_error("has " + std::to_string(result.values.size()) + " values where " +
                                         std::to_string(tuples) + " times " +
                                         std::to_string(result.components) + " are due");
            }
        } catch (const std::runtime_error& error) {
            throw std::runtime_error("array '" + result.name + "': " + error.what());
        }
        return result;
    }

    [[nodiscard]] VtkCells read_cells(const pugi::xml_node& element, std::size_t cells) const {
        VtkCells result;
        if (cells == 0) {
            return result;
        }
        const auto child = [&](const char* name) {
            return element.find_child_by_attribute("DataArray", "Name", name);
        };
        const std::vector<double> offsets = read_array(child("offsets"), cells).values;
        const std::vector<double> connectivity = read_values(child("connectivity"));
        double before = 0.0;
        for (const double offset : offsets) {
            if (!(offset >= before && offset <= static_cast<double>(connectivity.size()))) {
                throw std::runtime_error(std::string(element.name()) + ": an offset is out of range");
            }
            before = offset;
            result.offsets.push_back(static_cast<std::size_t>(offset));
        }
        constexpr std::uint32_t out_of_range = std::numeric_limits<std::uint32_t>::max();
        for (const double index : connectivity) {
            const bool fits = index >= 0.0 && index < static_cast<double>(out_of_range);
            result.connectivity.push_back(fits ? static_cast<std::uint32_t>(index) : out_of_range);
        }
        return result;
    }

    [[nodiscard]] static bool is_numeric(const pugi::xml_node& array) {
        const std::string_view type = array.attribute("type").value();
        return type.starts_with("Float") || type.starts_with("Int") || type.starts_with("UInt");
    }

    [[nodiscard]] VtpPiece read_piece(const pugi::xml_node& piece) const {
        VtpPiece result;
        result.points = piece.attribute("NumberOfPoints").as_ullong();
        if (result.points > 0) {
            const VtkArray points = read_array(piece.child("Points").child("DataArray"), result.points);
            if (points.components != 3) {
                throw std::runtime_error("its points do not have 3 components");
            }
            result.positions = points.values;
        }
        const pugi::xml_node point_data = piece.child("PointData");
        result.normals_name = point_data.attribute("Normals").value();
        result.uvs_name = point_data.attribute("TCoords").value();
        for (const pugi::xml_node array : point_data.children("DataArray")) {
            if (is_numeric(array)) {
                result.point_data.push_back(read_array(array, result.points));
            }
        }
        const auto cells = [&](const char* element, const char* number) {
            return read_cells(piece.child(element), piece.attribute(number).as_ullong());
        };
        result.lines = cells("Lines", "NumberOfLines");
        result.polys = cells("Polys", "NumberOfPolys");
        result.strips = cells("Strips", "NumberOfStrips");
        return result;
    }

    Appended appended_;
    pugi::xml_document document_;
    pugi::xml_node root_;
    VtkEncoding encoding_;
};

}  // namespace

std::vector<VtpPiece> read_vtp(const std::filesystem::path& file) {
    try {
        return Reader(read_file(file)).pieces();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::limit, file.string(), "no memory for its arrays");
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable VTP file: ") + error.what());
    }
}

}  // namespace viscera::io
