#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/io/file_info.h"
#include "samples/viscera/commands.h"
#include "samples/viscera/session.h"

namespace viscera::app {

namespace {

bool is_row(const nlohmann::json& value) {
    return value.is_array() &&
           std::ranges::none_of(value, [](const auto& one) { return one.is_structured(); });
}

/// As dump(2), with lists of numbers on one line: a histogram is a row.
void print(std::ostream& out, const nlohmann::json& value, const std::string& indent) {
    if (!value.is_structured() || value.empty() || is_row(value)) {
        out << value.dump();
        return;
    }
    const std::string inner = indent + "  ";
    out << (value.is_object() ? "{" : "[");
    std::string_view between = "\n";
    for (const auto& [key, one] : value.items()) {
        out << between << inner;
        if (value.is_object()) {
            out << nlohmann::json(key).dump() << ": ";
        }
        print(out, one, inner);
        between = ",\n";
    }
    out << "\n" << indent << (value.is_object() ? "}" : "]");
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("info", "Says what a mesh, centreline, picture or volume holds, as JSON");
    const auto file = std::make_shared<std::filesystem::path>();
    command
        ->add_option(
            "FILE", *file,
            "glTF, GLB, STL, OBJ, PLY, VTP, centreline JSON, EXR, PNG or JPEG; a volume: DICOM, NIfTI, "
            "NRRD, MetaImage, VTK, VTI, CSV, InVesalius project, JSON of a raw file, or a folder of slices")
        ->required();
    command->callback([file, &exit_code] {
        print(std::cout, io::describe(*file, stderr_log()), "");
        std::cout << '\n';
        exit_code = 0;
    });
}

}  // namespace viscera::app
