#include "engine/io/transfer_function.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/json_text.h"
#include "engine/core/params_json.h"
#include "engine/io/file_bytes.h"
#include "engine/io/transfer_function_readers.h"

namespace viscera::io {
namespace {

/// No file of a few curves is larger.
constexpr std::size_t most_bytes = std::size_t{64} << 20U;

[[noreturn]] void fail(const std::filesystem::path& file, const std::vector<JsonFault>& faults) {
    std::string message;
    constexpr std::size_t shown = 5;
    for (std::size_t i = 0; i < std::min(shown, faults.size()); ++i) {
        message += (i == 0 ? "" : "; ") + faults[i].pointer + (faults[i].pointer.empty() ? "" : ": ") +
                   faults[i].message;
    }
    if (faults.size() > shown) {
        message += "; and " + std::to_string(faults.size() - shown) + " more";
    }
    throw Error(ErrorCode::file, file.string(), message);
}

/// viscera's own form.
TransferFunction read_own(const JsonCursor& root) {
    TransferFunction function;
    std::string schema;
    std::string doc;
    const auto visit = [&](ParamVisitor& v) {
        v.field({.name = "$schema", .doc = "left to editors"}, schema);
        v.field({.name = "name", .doc = "name of the preset"}, function.name);
        v.field({.name = "doc", .doc = "what it shows"}, doc);
        v.field({.name = "technique", .doc = "how the volume is to be shown"}, function.technique);
        v.field({.name = "shaded", .doc = "whether surfaces are lit"}, function.shaded);
        v.field({.name = "lighting", .doc = "coefficients of the light"}, function.lighting);
        v.field({.name = "nearest", .doc = "no interpolation between voxels"}, function.nearest);
        v.field({.name = "reference_length_mm",
                 .doc = "length to which the opacities belong",
                 .unit = "mm",
                 .min = 0.0,
                 .min_excluded = true},
                function.reference_length_mm);
        v.field({.name = "points", .doc = "knots of colour and opacity", .required = true}, function.points);
        v.field({.name = "gradient", .doc = "factor on the opacity by gradient magnitude"},
                function.gradient);
    };
    std::vector<JsonFault> faults;
    read_params(root.value(), "", {}, visit, faults);
    if (!faults.empty()) {
        fail(root.file(), faults);
    }
    return function;
}

std::vector<TransferFunction> read_json(const std::filesystem::path& file, std::string_view text, Log& log) {
    std::vector<JsonFault> faults;
    const nlohmann::json document = parse_json(text, faults);
    if (!faults.empty()) {
        fail(file, faults);
    }
    const JsonCursor root(document, file);
    if (document.is_array() || document.contains("RGBPoints")) {
        return read_paraview(root, log);
    }
    if (document.contains("volumeProperties")) {
        return read_slicer_json(root, log);
    }
    if (document.contains("points")) {
        return {read_own(root)};
    }
    root.fail(
        "is no transfer function: neither a list of ParaView's colour maps, nor an object with \"points\" "
        "or 3D Slicer's \"volumeProperties\"");
}

/// The file's name without its endings.
std::string name_of(const std::filesystem::path& file) {
    std::filesystem::path name = file.stem();
    if (lower_extension(name) == ".vp") {
        name = name.stem();
    }
    return name.string();
}

}  // namespace

std::vector<TransferFunction> load_transfer_functions(const std::filesystem::path& file, Log& log) {
    const std::string extension = lower_extension(file);
    if (extension != ".vp" && extension != ".json") {
        throw Error(ErrorCode::file, file.string(),
                    "is no transfer function that can be read: .vp, .vp.json and .json can");
    }
    const std::string text = read_file(file, most_bytes);
    std::vector<TransferFunction> functions =
        extension == ".vp" ? std::vector{read_slicer_text(file, text)} : read_json(file, text, log);
    std::size_t faults = 0;
    for (TransferFunction& function : functions) {
        function = normalised(std::move(function), faults);
        if (function.name.empty()) {
            function.name = name_of(file);
        }
    }
    if (faults > 0) {
        log.fault("transfer function: numbers out of range",
                  file.string() + ": numbers outside of their range are cut, those not finite left out",
                  faults);
    }
    return functions;
}

}  // namespace viscera::io
