#include <iostream>

#include <nlohmann/json.hpp>

#include "engine/io/file_info.h"
#include "samples/viscera/commands.h"

namespace viscera::app {

void add_info(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("info", "Says what a mesh, centreline, picture or volume holds, as JSON");
    const auto file = std::make_shared<std::filesystem::path>();
    command
        ->add_option(
            "FILE", *file,
            "glTF, GLB, STL, OBJ, PLY, VTP, centreline JSON, EXR, PNG or JPEG; a volume: DICOM, NIfTI, "
            "NRRD, MetaImage, VTK, VTI, CSV, JSON of a raw file, or a folder of slices")
        ->required();
    command->callback([file, &exit_code] {
        std::cout << io::describe(*file).dump(2) << '\n';
        exit_code = 0;
    });
}

}  // namespace viscera::app
