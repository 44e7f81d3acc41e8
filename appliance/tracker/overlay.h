// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "appliance/tracker/tag_tracking.h"
#include "common/image/image.h"

namespace cyclorama::tracker {

/// The camera's picture for people: every tag's outline and id, and on the followed pattern its axes (x red, y green, z
/// blue, out of it towards the camera), distance and yaw. `tag` may be null. Reentrant.
[[nodiscard]] RgbImage draw_overlay(const GreyImage& picture, std::span<const tags::TagDetection> detections,
                                    const TrackedTag* tag, const Pinhole& lens);

/// Positive when the holder, who faces the camera, turns to the own right: the angle of the tag's normal about the
/// camera's y.
[[nodiscard]] double yaw_rad(const T_CameraTag& T_camera_tag);

}  // namespace cyclorama::tracker
