// SPDX-License-Identifier: Apache-2.0
// Replacement for builds without libcamera's headers.
#include "drivers/camera/libcamera/libcamera_camera.h"

namespace cyclorama::camera {

Result<std::unique_ptr<Camera>> open_libcamera_camera(std::string_view, const LibcameraOptions&, const Clock&) {
  return Error(ErrorCode::kInvalidArgument,
               "camera 'libcamera:': this program was built without libcamera; install libcamera-dev and build again, "
               "or use v4l2:");
}

std::vector<ListedCamera> list_libcamera_cameras() { return {}; }

}  // namespace cyclorama::camera
