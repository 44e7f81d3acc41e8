// SPDX-License-Identifier: Apache-2.0
/// calibrator.toml, and devices that are given in one line.
#include <cstddef>
#include <cstdint>
#include <string>

#include "appliance/calibrator/calibrator_settings.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto settings = calibrator::CalibratorSettings::parse(text, "fuzz.toml");
  if (settings) {
    CHECK(settings->field_of_view_rad > 0.0 && settings->field_of_view_rad < 3.0);
    CHECK(settings->watch_hz > 0.0 && settings->watch_exposure_s > 0.0 && settings->max_exposure_s > 0.0);
    for (const scan::CameraSource& camera : settings->watch) {
      const auto again = scan::parse_camera_source(camera.name + "=" + camera.spec);
      CHECK(again && again->name == camera.name && again->spec == camera.spec);
    }
  } else {
    CHECK(settings.error().message().find("fuzz.toml") != std::string::npos);
  }
  const auto display = scan::parse_pattern_display(text);
  CHECK(!display || !display->address.empty());
  return 0;
}
