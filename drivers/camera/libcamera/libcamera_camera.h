// SPDX-License-Identifier: Apache-2.0
/// Cameras that only libcamera can drive: sensors on a board's own bus (Raspberry Pi, i.MX, Rockchip, Intel IPU), which
/// need a configured pipeline and an exposure control loop. A camera that the kernel presents as a complete device is
/// better opened as v4l2, which involves fewer layers and gives clearer errors.
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
  /// Exposure time of a fixed exposure, with the gain at libcamera's default. Zero selects libcamera's automatic
  /// exposure.
  Duration exposure = std::chrono::milliseconds(5);
};

/// Opens the camera with this id, which names its position on the board's bus; an empty id selects the first one.
///
/// Errors: kNotFound if there is no such camera (the message lists those present); kInvalidArgument if this build has
/// no libcamera; kUnavailable if libcamera itself does not start; kSystem if the camera offers no readable pixel
/// format.
Result<std::unique_ptr<Camera>> open_libcamera_camera(std::string_view id, const LibcameraOptions& options,
                                                      const Clock& clock);

/// Returns the cameras present now; empty without libcamera. USB cameras are excluded, since V4L2 lists them.
[[nodiscard]] std::vector<ListedCamera> list_libcamera_cameras();

}  // namespace cyclorama::camera
