#pragma once

#include <cstdint>

#include "assets/generate/vessel_tree.h"

namespace viscera::assets {

/// Points that a scene places things at [mm, world].
struct CoronaryLandmarks {
    glm::dvec3 ostium_mm{0.0};     ///< mouth of the left main artery, at the catheter's tip
    glm::dvec3 into_root_mm{0.0};  ///< unit direction from the ostium back into the aortic root (reflux)
    glm::dvec3 lad_middle_mm{0.0};
    glm::dvec3 lad_outward_mm{0.0};  ///< unit direction off the heart at lad_middle_mm (extravasation)
    double lad_middle_radius_mm = 0.0;
};

/// A left coronary tree, filled through a catheter.
struct Coronary {
    VesselTree tree;
    CoronaryLandmarks landmarks;
};

/// Grows the tree: catheter, left main, anterior descending artery (LAD) with diagonals, septals and right
/// ventricular branches, circumflex (LCx) with obtuse marginals, and their twigs, on the heart's surface.
/// Courses never come near each other, so that the lumen has no loop. Radii obey Murray's law at each
/// branching (the catheter's mouth apart). The same seed gives the same tree.
[[nodiscard]] Coronary grow_coronary(std::uint64_t seed);

}  // namespace viscera::assets
