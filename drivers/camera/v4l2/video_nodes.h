// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/camera/listed_camera.h"
#include "drivers/camera/v4l2/video_device.h"

namespace cyclorama::camera {

/// An open device and the name by which it is found again.
struct NamedDevice {
  VideoDevice device;
  std::string port_path;  ///< Port of the device; "PORT+1" for the second camera at one port, as with a stereo camera.
};

/// Opens the camera at `where`: a path ("/dev/v4l/by-path/..."), a port path as in NamedDevice, or the first camera
/// present if `where` is empty.
///
/// Errors: kNotFound if there is no such camera (the message lists those present); others are those of
/// VideoDevice::open().
Result<NamedDevice> open_video_device(std::string_view where);

/// Returns every camera that is present, including those that cannot be opened.
[[nodiscard]] std::vector<ListedCamera> list_v4l2_cameras();

}  // namespace cyclorama::camera
