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
#include "engine/io/vtk_xml.h"

namespace viscera::io {

namespace {

class VtpReader {
  public:
    explicit VtpReader(std::string text) : xml_(std::move(text), "PolyData") {}

    [[nodiscard]] std::vector<VtpPiece> pieces() const {
        std::vector<VtpPiece> pieces;
        for (const pugi::xml_node piece : xml_.root().child("PolyData").children("Piece")) {
            pieces.push_back(read_piece(piece));
        }
        return pieces;
    }

  private:
    /// An array of `tuples` tuples. What it lacks or has too much is an error that names it.
    [[nodiscard]] VtkArray read_array(const pugi::xml_node& array, std::size_t tuples) const {
        VtkArray result;
        result.name = array.attribute("Name").value();
        result.components = array.attribute("NumberOfComponents").as_uint(1);
        try {
            result.values = xml_.values(array);
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
        const std::vector<double> connectivity = xml_.values(child("connectivity"));
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

    VtkXml xml_;
};

}  // namespace

std::vector<VtpPiece> read_vtp(const std::filesystem::path& file) {
    try {
        return VtpReader(read_file(file)).pieces();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::limit, file.string(), "no memory for its arrays");
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable VTP file: ") + error.what());
    }
}

}  // namespace viscera::io
