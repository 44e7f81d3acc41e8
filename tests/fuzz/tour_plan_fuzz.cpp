// SPDX-License-Identifier: Apache-2.0
/// tour.toml, and Voyager's documents: whatever is read can be written and read again.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "kiosk/tour/plan/svx_import.h"
#include "kiosk/tour/plan/tour_plan.h"
#include "kiosk/tour/plan/tour_plan_text.h"

using namespace cyclorama::tour;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static const auto area = WalkableArea::make({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
  if (const auto plan = parse_tour_plan(text, "tour.toml", &*area)) {
    CHECK(!plan->stops.empty() && plan->stops.size() <= kMaxPlannedStops);
    for (const PlannedStop& planned : plan->stops) CHECK(area->allows(planned.stop.position_m));
    CHECK(parse_tour_plan(to_toml(*plan), "again.toml"));
  }
  if (const auto import = import_svx(text, "a.svx.json")) CHECK(parse_tour_plan(to_toml(import->plan), "again.toml"));
  return 0;
}
