#pragma once

#include "engine/core/camera.h"

namespace viscera::app {

/// Turns the camera about what it looks at. x, y: of the window's height, to the right and up; half a height
/// turns by 90 degrees.
void rotate(CameraParams& camera, double x, double y);
/// Moves what the camera looks at, so that the picture follows the hand. x, y: of the window's height.
void pan(CameraParams& camera, double x, double y);
/// Scales the picture; factor > 1 comes nearer.
void zoom(CameraParams& camera, double factor);
/// 1: from the front, 3: from the patient's left, 7: from the head.
void standard_view(CameraParams& camera, int digit);

}  // namespace viscera::app
