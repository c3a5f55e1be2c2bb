#include <charconv>
#include <cmath>
#include <iostream>

#include "engine/core/error.h"
#include "engine/core/image_compare.h"
#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"
#include "engine/io/png.h"
#include "samples/viscera/commands.h"

namespace viscera::app {
namespace {

struct DiffArguments {
    std::filesystem::path a;
    std::filesystem::path b;
    CompareLimits limits;
    std::filesystem::path heatmap;
};

std::vector<io::ExrPart> read_parts(const std::filesystem::path& file) {
    if (io::lower_extension(file) == ".exr") {
        return io::read_exr(file);
    }
    return {{.name = file.stem().string(), .image = io::read_image(file)}};
}

/// Whether pixels can be held against each other.
bool same_shape(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.channels() == b.channels();
}

void print(const CompareResult& result) {
    std::cout << "  max " << result.max << "  mean " << result.mean << "  rms " << result.rms << "  psnr "
              << result.psnr_db << " dB  fraction " << result.fraction << "  nan " << result.nan << "  inf "
              << result.inf;
    if (result.worst_x >= 0) {
        std::cout << "  worst at " << result.worst_x << "," << result.worst_y << " channel "
                  << result.worst_channel;
    }
    std::cout << '\n';
}

/// Compares part by part; a part that only one file has is a difference.
int diff(const DiffArguments& arguments) {
    const std::vector<io::ExrPart> a = read_parts(arguments.a);
    const std::vector<io::ExrPart> b = read_parts(arguments.b);
    if (a.size() != b.size()) {
        std::cout << "different: " << a.size() << " and " << b.size() << " pictures\n";
        return 1;
    }
    int exit_code = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a.size() > 1 && a[i].name != b[i].name) {
            std::cout << "different: '" << a[i].name << "' stands against '" << b[i].name << "'\n";
            exit_code = 1;
            continue;
        }
        const CompareResult result = compare(a[i].image, b[i].image, arguments.limits);
        std::cout << (a.size() > 1 ? a[i].name + ": " : "")
                  << (result.equal ? "equal" : "different: " + result.reason) << '\n';
        exit_code = result.equal ? exit_code : 1;
        if (!same_shape(a[i].image, b[i].image)) {
            continue;
        }
        print(result);
        if (!arguments.heatmap.empty()) {
            std::filesystem::path file = arguments.heatmap;
            if (a.size() > 1) {
                file.replace_filename(file.stem().string() + "." + a[i].name + file.extension().string());
            }
            io::write_png(file, heatmap(a[i].image, b[i].image), {.alpha = false});
        }
    }
    return exit_code;
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "diff",
        "Compares two pictures (EXR, PNG, JPEG); exit code 1 when they differ. NaN and Inf never pass");
    const auto arguments = std::make_shared<DiffArguments>();
    // CLI11's own check lets NaN pass and says up to which of 309 digits a number may go.
    const CLI::Validator not_negative(
        [](const std::string& text) {
            double value = -1.0;
            const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool whole = failure == std::errc{} && end == text.data() + text.size();
            return whole && value >= 0.0 ? "" : "'" + text + "' is no number of at least 0";
        },
        "");
    command->add_option("A", arguments->a, "picture")->required();
    command->add_option("B", arguments->b, "picture")->required();
    command->add_option("--max", arguments->limits.max, "largest absolute difference let pass")
        ->check(not_negative);
    command->add_option("--mean", arguments->limits.mean, "mean absolute difference let pass; default: --max")
        ->check(not_negative)
        ->default_str("");
    command->add_option("--fraction", arguments->limits.fraction, "share of pixels that may exceed --max")
        ->check(CLI::Range(0.0, 1.0));
    command->add_option("--heatmap", arguments->heatmap, "writes where they differ as PNG");
    command->callback([arguments, command, &exit_code] {
        if (command->count("--mean") == 0) {
            arguments->limits.mean = command->count("--fraction") > 0 ? 1e30 : arguments->limits.max;
        }
        exit_code = diff(*arguments);
    });
}

}  // namespace viscera::app
