// SPDX-License-Identifier: Apache-2.0
/// Cameras that only libcamera drives: sensors on a board's own bus (Raspberry Pi, i.MX, Rockchip, Intel IPU), whose
/// pictures need a pipeline set up and an exposure loop run. One that the kernel presents whole is better opened as
/// v4l2: a step less, and its errors are plainer.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/listed_camera.h"
#include "drivers/camera/picture_choice.h"

namespace cyclorama::camera {

struct LibcameraOptions {
  PicturePreference preferred;
  /// As of a V4L2 camera; the gain is then libcamera's own default. Zero: its automatic exposure.
  Duration exposure = std::chrono::milliseconds(5);
};

/// The camera of this id, which names its place on the board's bus; the first that is there for an empty one.
///
/// kNotFound         none such; the message lists those that are there.
/// kInvalidArgument  this build has no libcamera.
/// kUnavailable      libcamera itself does not start.
/// kSystem           it sends no pixels that can be read.
Result<std::unique_ptr<Camera>> open_libcamera_camera(std::string_view id, const LibcameraOptions& options,
                                                      const Clock& clock);

/// Those that are there now; none without libcamera. USB cameras are not among them: they are V4L2's.
[[nodiscard]] std::vector<ListedCamera> list_libcamera_cameras();

}  // namespace cyclorama::camera
