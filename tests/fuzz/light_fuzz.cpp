// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/photometry/light_file.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto light = photometry::parse_light({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!light) {
    CHECK(light.error().message().find("; ") != std::string::npos);
    return 0;
  }
  // An accepted measurement is unchanged by a round trip, and it is physically valid.
  const std::string written = photometry::light_json(*light);
  const auto back = photometry::parse_light(written, "fuzz");
  CHECK(back.has_value() && photometry::light_json(*back) == written);
  for (const photometry::ProjectorLighting& one : light->lighting.projectors) {
    const double white = one.white_at({3.0, 5.0});
    CHECK(white > 0.0 && std::isfinite(white));
  }
  return 0;
}
