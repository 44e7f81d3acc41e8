// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/calibration/camera_file.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto camera = calibration::parse_camera({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!camera) {
    CHECK(camera.error().code() == ErrorCode::kBadData && !camera.error().message().empty());
    return 0;
  }
  // An accepted lens is unchanged by a round trip, and every pixel has a direction.
  const std::string written = calibration::camera_json(*camera);
  const auto back = calibration::parse_camera(written, "fuzz");
  CHECK(back.has_value() && calibration::camera_json(*back) == written);
  CHECK(camera->lens.direction_at({0.5 * camera->lens.width_px, 0.5 * camera->lens.height_px}).has_value());
  return 0;
}
