// SPDX-License-Identifier: Apache-2.0
/// All differences between Debian 12's libcamera (0.0.3) and Debian 13's (0.4). Internal to the libcamera camera.
#pragma once

// libcamera's headers do not compile without warnings at our warning level.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wold-style-cast"
#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/property_ids.h>
#include <libcamera/request.h>
#include <libcamera/stream.h>
#include <libcamera/version.h>
#pragma GCC diagnostic pop

#include <memory>

namespace cyclorama::camera {

/// Returns null if the camera has no viewfinder stream.
inline std::unique_ptr<libcamera::CameraConfiguration> viewfinder_of(libcamera::Camera* camera) {
#if LIBCAMERA_VERSION_MAJOR == 0 && LIBCAMERA_VERSION_MINOR == 0
  return camera->generateConfiguration(libcamera::StreamRoles{libcamera::StreamRole::Viewfinder});
#else
  return camera->generateConfiguration({libcamera::StreamRole::Viewfinder});
#endif
}

/// Sets a fixed exposure in microseconds, if the camera supports it.
inline void fix_exposure(const libcamera::ControlInfoMap& known, std::int32_t exposure_us,
                         libcamera::ControlList* ret_controls) {
  // Version 0.5 splits AeEnable in two; before that it controls both exposure and gain.
  if (known.count(&libcamera::controls::AeEnable) != 0) ret_controls->set(libcamera::controls::AeEnable, false);
  if (known.count(&libcamera::controls::ExposureTime) != 0) {
    ret_controls->set(libcamera::controls::ExposureTime, exposure_us);
  }
}

}  // namespace cyclorama::camera
