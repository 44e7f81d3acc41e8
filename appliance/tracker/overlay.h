// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "appliance/tracker/tag_tracking.h"
#include "common/image/image.h"

namespace cyclorama::tracker {

/// Returns the camera's picture with every tag's outline and id and, for the followed pattern, its axes (x red, y
/// green, z blue, towards the camera), distance and yaw. `tag` may be null. Reentrant.
[[nodiscard]] RgbImage draw_overlay(const GreyImage& picture, std::span<const tags::TagDetection> detections,
                                    const TrackedTag* tag, const Pinhole& lens);

/// Returns the angle of the tag's normal about the camera's y; positive when the holder, who faces the camera, turns to
/// the right.
[[nodiscard]] double yaw_rad(const T_CameraTag& T_camera_tag);

}  // namespace cyclorama::tracker
