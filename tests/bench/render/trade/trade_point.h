// SPDX-License-Identifier: Apache-2.0
/// What one setting costs and how wrong its picture is, and the files in which that is told.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/governor/front.h"
#include "renderfarm/quality/shown_error.h"
#include "tests/bench/render/trade/trade_plan.h"

namespace cyclorama {

struct TradePoint {
  PlannedPoint planned;
  double cpu_s = 0.0;   ///< Of all threads, from the first ray to the last byte.
  double wall_s = 0.0;  ///< The same.
  std::uint64_t rays = 0;
  std::size_t bytes = 0;       ///< Of the whole picture as one JPEG.
  double removed_light = 0.0;  ///< By the firefly limit, as a part of all light.
  double relmse = 0.0;         ///< Of the light, before tone mapping and JPEG, enlarged.
  ShownError shown;            ///< Of the decoded JPEG, enlarged.
};

/// Which points the governor may choose: the front of processor time against relMSE (as Front::standard() has it:
/// without bias it falls with the samples, which Refinement builds on), among those that are sent as the base is (JPEG
/// is not in it). `shown_px` is the picture's size. kInvalidArgument  there is no such point.
Result<Front> trade_front(const std::vector<TradePoint>& points, double shown_px);
[[nodiscard]] bool is_on(const Front& front, const TradePoint& point);

/// A header and one line per point; its columns carry their units.
[[nodiscard]] std::string trade_csv(const std::vector<TradePoint>& points, const Front& front);

/// Error against time and against bytes, a curve for each knob, and the front.
[[nodiscard]] std::string trade_svg(const std::vector<TradePoint>& points, const Front& front,
                                    const std::string& title);

}  // namespace cyclorama
