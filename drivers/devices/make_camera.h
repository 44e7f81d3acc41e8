// SPDX-License-Identifier: Apache-2.0
/// Any camera from one line of text, as it stands in a config file or behind --camera:
///
///   # camera
///   v4l2                                               # The first camera of the kernel's (Video4Linux).
///   v4l2:usb-0000:00:14.0-2?exposure_ms=5              # By its port.
///   v4l2:/dev/v4l/by-path/pci-0000:00:14.0-usb-0:2:1.0-video-index0?width_px=1280&height_px=720
///   libcamera                                          # The first camera that only libcamera drives; or by its id.
///   file:/srv/recordings/visit.mp4?loop=no             # A photo, a folder of photos, or a video.
///   file:/srv/photos?frames_per_second=10
///   simulated                                          # A hand with a tag: the demo's,
///   simulated:hand.toml                                # or as a file describes it (docs/reference/settings.md).
///
/// Options of v4l2 and libcamera, joined by '&':
///
///   width_px=N height_px=N frames_per_second=N   the nearest mode is taken
///   exposure_ms=N                                0: the camera's own
///   colour=yes                                   colours beside the brightness, where the camera has them
///   gain=held                                    v4l2: gain, white balance and focus stay as they are, so that
///                                                pictures can be compared
///   memory=dma_buf                               v4l2: buffers that other devices can read; the default is mapped
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/listed_camera.h"

namespace cyclorama::devices {

/// Borrows `clock` for the camera's whole life.
///
/// kInvalidArgument  the line itself is wrong and says what is legal; trying again cannot help.
/// kNotFound, kBusy, kUnavailable, kBadData, kSystem  what it names cannot be opened (now).
Result<std::unique_ptr<camera::Camera>> make_camera(std::string_view spec, const Clock& clock);

/// The real cameras of this machine. Blocks while the drivers are asked, a second at most.
[[nodiscard]] std::vector<camera::ListedCamera> list_cameras();

}  // namespace cyclorama::devices
