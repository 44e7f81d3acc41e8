// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/calibration/colour_file.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto colours = calibration::parse_colours({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!colours) {
    CHECK(colours.error().message().find("; ") != std::string::npos);
    return 0;
  }
  // Accepted colours are unchanged by a round trip, and heads can draw with them.
  const std::string written = calibration::colours_json(*colours);
  const auto back = calibration::parse_colours(written, "fuzz");
  CHECK(back.has_value() && calibration::colours_json(*back) == written);
  for (const calibration::CalibratedColour& one : *colours) {
    if (!one.colour.response) continue;
    for (const warp::ResponseCurve& curve : *one.colour.response) CHECK(curve.is_valid());
  }
  return 0;
}
