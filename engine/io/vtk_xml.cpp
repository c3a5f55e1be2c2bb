#include "engine/io/vtk_xml.h"

#include <stdexcept>

namespace viscera::io {

/// Cuts the appended bytes out of `text` and leaves well-formed XML.
VtkXml::Appended VtkXml::cut_appended(std::string& text) {
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

VtkXml::VtkXml(std::string text, std::string_view type) : appended_(cut_appended(text)) {
    const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
        throw std::runtime_error(std::string(parsed.description()) + " at byte " +
                                 std::to_string(parsed.offset));
    }
    root_ = document_.child("VTKFile");
    if (const std::string_view found = root_.attribute("type").value(); found != type) {
        throw std::runtime_error("its VTKFile type is '" + std::string(found) + "', not " +
                                 std::string(type));
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

bool VtkXml::is_text(const pugi::xml_node& array) {
    const std::string_view format = array.attribute("format").value();
    if (!format.empty() && format != "ascii" && format != "binary" && format != "appended") {
        throw std::runtime_error("array format '" + std::string(format) + "' is unknown");
    }
    return format.empty() || format == "ascii";
}

std::string VtkXml::stored_bytes(const pugi::xml_node& array) const {
    if (std::string_view(array.attribute("format").value()) == "binary") {
        return decode_base64(array.child_value());
    }
    const std::size_t offset = array.attribute("offset").as_ullong();
    if (offset >= appended_.bytes.size()) {
        throw std::runtime_error("an array begins beyond the appended data");
    }
    const auto next = appended_.offsets.upper_bound(offset);
    const std::size_t end = appended_.base64 && next != appended_.offsets.end() ? *next : std::string::npos;
    const std::string_view bytes = std::string_view(appended_.bytes).substr(offset, end - offset);
    return appended_.base64 ? decode_base64(bytes) : std::string(bytes);
}

std::string VtkXml::bytes(const pugi::xml_node& array) const {
    return decode_vtk_bytes(stored_bytes(array), encoding_);
}

std::vector<double> VtkXml::values(const pugi::xml_node& array) const {
    if (is_text(array)) {
        return parse_vtk_text(array.child_value());
    }
    return decode_vtk_array(stored_bytes(array), array.attribute("type").value(), encoding_);
}

}  // namespace viscera::io
