#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/io/temp_folder.h"

namespace viscera::test {

/// A square in the plane z = 0 from (0, 0) to (side, side) [mm], as an OBJ file of cells x cells squares. Its
/// texture coordinates leave a margin of 1/16. `seam`: cut at half its length along x; the two charts lie one
/// above the other, the second turned by 90 degrees. `stretch`: > 1 makes texels narrower in x than in y.
struct Plane {
    double side_mm = 40.0;
    int cells = 16;
    bool seam = false;
    double stretch = 1.0;

    [[nodiscard]] std::filesystem::path write(const std::string& name) const {
        const auto file = process_folder() / (name + ".obj");
        std::ofstream out(file);
        out.precision(9);
        const int row = cells + 1;
        for (int y = 0; y <= cells; ++y) {
            for (int x = 0; x <= cells; ++x) {
                out << "v " << side_mm * x / cells << ' ' << side_mm * y / cells << " 0\n";
            }
        }
        const int charts = seam ? 2 : 1;
        for (int chart = 0; chart < charts; ++chart) {
            for (int y = 0; y <= cells; ++y) {
                for (int x = 0; x <= cells; ++x) {
                    const double u = static_cast<double>(x) / cells;
                    const double v = static_cast<double>(y) / cells;
                    if (!seam) {
                        out << "vt " << 0.0625 + 0.875 * u / stretch << ' ' << 0.0625 + 0.875 * v << "\n";
                    } else if (chart == 0) {
                        out << "vt " << 0.0625 + 0.8 * u << ' ' << 0.0625 + 0.8 * v << "\n";
                    } else {  // u - 1/2 runs down the texture's side
                        out << "vt " << 0.55 + 0.8 * 0.5 * (1.0 - v) << ' ' << 0.0625 + 0.8 * (u - 0.5)
                            << "\n";
                    }
                }
            }
        }
        for (int y = 0; y < cells; ++y) {
            for (int x = 0; x < cells; ++x) {
                const int offset = seam && x >= cells / 2 ? row * row : 0;
                const auto corner = [&](int i, int j) {
                    const int v = 1 + (y + j) * row + x + i;
                    return std::to_string(v) + "/" + std::to_string(v + offset);
                };
                out << "f " << corner(0, 0) << ' ' << corner(1, 0) << ' ' << corner(1, 1) << "\n";
                out << "f " << corner(0, 0) << ' ' << corner(1, 1) << ' ' << corner(0, 1) << "\n";
            }
        }
        return file;
    }
};

}  // namespace viscera::test
