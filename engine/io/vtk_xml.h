#pragma once

#include <cstddef>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/vtk_data.h"

namespace viscera::io {

/// A VTK XML file (.vtp, .vti) with its arrays, however they are stored: text, base64, appended, packed with
/// zlib. All members throw std::runtime_error where the file does not hold.
class VtkXml {
  public:
    /// `type`: that of the VTKFile element, "PolyData" or "ImageData".
    VtkXml(std::string text, std::string_view type);

    [[nodiscard]] pugi::xml_node root() const { return root_; }
    /// Numbers of a DataArray.
    [[nodiscard]] std::vector<double> values(const pugi::xml_node& array) const;
    /// Whether a DataArray's numbers are text.
    [[nodiscard]] static bool is_text(const pugi::xml_node& array);
    /// Bytes of a DataArray that is no text, in the file's byte order.
    [[nodiscard]] std::string bytes(const pugi::xml_node& array) const;
    [[nodiscard]] bool is_big_endian() const { return encoding_.big_endian; }

  private:
    /// The bytes behind the '_' of AppendedData, cut out of the text since raw ones are no XML.
    struct Appended {
        std::string bytes;
        bool base64 = false;
        std::set<std::size_t> offsets;  ///< where each array begins
    };
    [[nodiscard]] static Appended cut_appended(std::string& text);
    /// An array's own bytes with its header, decoded from base64.
    [[nodiscard]] std::string stored_bytes(const pugi::xml_node& array) const;

    Appended appended_;
    pugi::xml_document document_;
    pugi::xml_node root_;
    VtkEncoding encoding_;
};

}  // namespace viscera::io
