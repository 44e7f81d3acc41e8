// SPDX-License-Identifier: Apache-2.0
/// Makes any camera from one line of text, as used in a settings file or after --camera:
///
///   # camera
///   v4l2                                               # The first V4L2 camera.
///   v4l2:usb-0000:00:14.0-2?exposure_ms=5              # The camera at this port.
///   v4l2:/dev/v4l/by-path/pci-0000:00:14.0-usb-0:2:1.0-video-index0?width_px=1280&height_px=720
///   libcamera                                          # The first camera of libcamera; ":ID" selects another.
///   file:/srv/recordings/visit.mp4?loop=no             # A photo, a folder of photos, or a video.
///   file:/srv/photos?frames_per_second=10
///   simulated                                          # A hand with a tag: the demo's movement,
///   simulated:hand.toml                                # or one from a file (docs/reference/settings.md).
///
/// Options of v4l2 and libcamera, joined by '&':
///
///   width_px=N height_px=N frames_per_second=N   the nearest mode is used
///   exposure_ms=N                                0: automatic exposure of the camera
///   colour=yes                                   colour in addition to brightness, if the camera has it
///   gain=held                                    v4l2: gain, white balance and focus stay fixed, so that
///                                                pictures can be compared
///   memory=dma_buf                               v4l2: buffers that other devices can read; the default is mapped
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/listed_camera.h"

namespace cyclorama::devices {

/// `clock` must outlive the camera.
///
/// Errors: kInvalidArgument if the line itself is wrong (the message states what is valid; a retry cannot help);
/// kNotFound, kBusy, kUnavailable, kBadData or kSystem if the camera cannot be opened now.
Result<std::unique_ptr<camera::Camera>> make_camera(std::string_view spec, const Clock& clock);

/// Lists the real cameras of this machine. Blocks while the drivers are queried, at most for a second.
[[nodiscard]] std::vector<camera::ListedCamera> list_cameras();

}  // namespace cyclorama::devices
