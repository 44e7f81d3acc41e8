// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/calibration/calibration_file.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto calibration = calibration::parse_calibration({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!calibration) {
    CHECK(calibration.error().message().find("; ") != std::string::npos);
    return 0;
  }
  // An accepted calibration is unchanged by a round trip, and its wall gives numbers or nothing.
  const std::string written = calibration::calibration_json(*calibration);
  const auto back = calibration::parse_calibration(written, "fuzz");
  CHECK(back.has_value() && calibration::calibration_json(*back) == written);
  if (!calibration->wall) return 0;
  for (const Eigen::Vector3d& d :
       {Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(0.6, 0.0, -0.8), Eigen::Vector3d(0.0, 1.0, 0.0)}) {
    const auto inverse_depth = calibration->wall->fit.surface.inverse_depth_at(d);
    CHECK(!inverse_depth || std::isfinite(*inverse_depth));
  }
  return 0;
}
