#pragma once

#include <vector>

#include "assets/generate/gray_image.h"
#include "assets/generate/rays.h"

namespace viscera::assets {

/// A curved tube in space, drawn into pictures by its projected thickness.
struct Tube {
    struct Point {
        glm::dvec3 position_mm{0.0};
        double radius_mm = 1.0;
        double density = 1.0;  ///< relative
    };
    std::vector<Point> points;  ///< at least 2
};

/// Adds `weight` times the length of each ray inside the tube [mm] to the picture. Where a tube lies in front
/// of itself the longer piece counts; along the line of sight the length is capped at 4 radii.
void draw_tube(const Tube& tube, double weight, const ConeBeam& beam, GrayImage& image);

}  // namespace viscera::assets
