// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "appliance/tracker/tracker_settings.h"

/// Any text yields valid settings or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto settings = cyclorama::tracker::TrackerSettings::parse(text, "fuzz.toml");
  if (settings && !(cyclorama::tracker::lens_for(settings->lens, 640, 480).focal_px > 0.0)) std::abort();
  return 0;
}
