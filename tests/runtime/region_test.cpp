#include "engine/runtime/region.h"

#include <gtest/gtest.h>

#include "engine/core/camera.h"

namespace viscera::test {
namespace {

Bounds box_at(const glm::vec3& centre, float half = 5.0F) {
    Bounds bounds;
    bounds.extend(centre - half);
    bounds.extend(centre + half);
    return bounds;
}

TEST(ProjectBounds, IsEmptyOutsideTheViewAndBehindTheEye) {
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic}) {
        CameraParams camera;
        camera.kind = kind;
        camera.eye_mm = {0, -100, 0};
        camera.height_mm = 60;
        const glm::dmat4 matrix = make_view(camera, 1.0).view_projection();
        const glm::ivec2 size(64, 64);
        EXPECT_FALSE(project_bounds(box_at({0, 0, 0}), matrix, size).empty());
        EXPECT_TRUE(project_bounds(box_at({900, 0, 0}), matrix, size).empty());
        EXPECT_TRUE(project_bounds(box_at({0, -400, 0}), matrix, size).empty());
        EXPECT_TRUE(project_bounds(box_at({300, -400, 9000}), matrix, size).empty());
        EXPECT_TRUE(project_bounds(box_at({0, 20000, 0}), matrix, size).empty());
        EXPECT_TRUE(project_bounds(Bounds(), matrix, size).empty());
        // Around the eye, anything may be seen.
        EXPECT_EQ(project_bounds(box_at({0, -100, 0}, 20.0F), matrix, size), (PixelRect{0, 0, 64, 64}));
    }
}

}  // namespace
}  // namespace viscera::test
