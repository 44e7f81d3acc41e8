// SPDX-License-Identifier: Apache-2.0
/// The display's part of site.toml.
#include <cstddef>
#include <cstdint>

#include "appliance/display/display_settings.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto settings =
      cyclorama::display::parse_display_settings({reinterpret_cast<const char*>(data), size}, "site.toml");
  if (settings) {
    CHECK(settings->attract_times.after >= std::chrono::milliseconds(500));
    CHECK(settings->attract_times.fade >= std::chrono::milliseconds(10));
  }
  return 0;
}
