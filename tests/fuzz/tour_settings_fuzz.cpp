// SPDX-License-Identifier: Apache-2.0
/// site.toml, and the position that a tour saves.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "kiosk/tour/session/tour_settings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto settings = cyclorama::tour::parse_tour_settings({reinterpret_cast<const char*>(data), size}, "site.toml");
  if (settings) {
    CHECK(!settings->coordinators.empty());
    CHECK(settings->navigation.tag.yaw_rad.full > settings->navigation.tag.yaw_rad.dead);
    CHECK(settings->navigation.limits.acceleration_m_per_s2 > 0.0);
    CHECK(settings->picture.guard_rad >= 0.0 && settings->picture.guard_rad < 2.0);
  }
  const auto position =
      cyclorama::tour::parse_saved_position({reinterpret_cast<const char*>(data), size}, "place.toml");
  if (position) {
    const auto again = cyclorama::tour::parse_saved_position(cyclorama::tour::to_text(*position), "place.toml");
    CHECK(again && *again == *position);
  }
  return 0;
}
