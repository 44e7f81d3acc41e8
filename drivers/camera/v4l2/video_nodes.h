// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/camera/listed_camera.h"
#include "drivers/camera/v4l2/video_device.h"

namespace cyclorama::camera {

/// A device, and the name by which it is found again.
struct NamedDevice {
  VideoDevice device;
  std::string port_path;  ///< Its port; "PORT+1" for the second camera at one port, as of a stereo camera.
};

/// Opens the camera at `where`: a path ("/dev/v4l/by-path/..."), a place as in NamedDevice, or nothing for the first
/// that is there.
///
/// kNotFound  none such; the message lists those that are there. Others as VideoDevice::open().
Result<NamedDevice> open_video_device(std::string_view where);

/// Every camera that is there now, also those that cannot be opened.
[[nodiscard]] std::vector<ListedCamera> list_v4l2_cameras();

}  // namespace cyclorama::camera
