// SPDX-License-Identifier: Apache-2.0
/// A record of costs, and a balancer that uses it.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/cost_record.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto frames = balance::parse_cost_record(std::as_bytes(std::span(data, size)), "fuzz");
  if (!frames) return 0;
  const auto balancer = balance::make_balancer(balance::BalanceStrategy::kCostMapStealing);
  const std::vector<double> speeds{1.0, 0.5, 2.0};
  for (const balance::RecordedFrame& frame : *frames) {
    const balance::PictureSize picture = frame.work.size();
    CHECK(balance::cells_in(picture.width) == frame.work.columns() &&
          balance::cells_in(picture.height) == frame.work.rows());
    const auto cells = frame.work.cells();
    for (const float work : cells) CHECK(std::isfinite(work) && work >= 0.0f);
    double seconds = 0.0;
    for (const balance::PlannedBlock& block : balancer->split(
             {picture, speeds, frame.heading_rad, frame.azimuth_span_rad, 0.0, 0.0, frame.eye_m, frame.effort})) {
      CHECK(!block.rect.empty() && std::isfinite(block.predicted_seconds));
      seconds += block.predicted_seconds;
    }
    CHECK(seconds >= 0.0);
    const std::vector<balance::MeasuredBlock> measured{
        {{0, 0, picture.width, picture.height}, frame.work.total(), {cells.begin(), cells.end()}}};
    balancer->learn({picture, measured, frame.heading_rad, frame.eye_m, frame.effort});
  }
  return 0;
}
