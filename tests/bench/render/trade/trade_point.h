// SPDX-License-Identifier: Apache-2.0
/// Cost and error of one setting, and the files that report them.
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
  double cpu_s = 0.0;   ///< All threads, from the first ray to the last byte.
  double wall_s = 0.0;  ///< From the first ray to the last byte.
  std::uint64_t rays = 0;
  std::size_t bytes = 0;       ///< The whole picture as one JPEG.
  double removed_light = 0.0;  ///< Fraction of all light removed by the firefly limit.
  double relmse = 0.0;         ///< Light before tone mapping and JPEG, enlarged.
  quality::ShownError shown;   ///< Decoded JPEG, enlarged.
};

/// Points that the governor may choose: the Pareto front of processor time against relMSE (as in
/// ParetoFront::standard(): without bias it falls with the samples, on which Refinement relies), among those with the
/// base's coding (JPEG is not part of it). `shown_px` is the picture's number of pixels. Errors: kInvalidArgument if
/// there is no such point.
Result<governor::ParetoFront> trade_pareto_front(const std::vector<TradePoint>& points, double shown_px);
[[nodiscard]] bool is_on(const governor::ParetoFront& front, const TradePoint& point);

/// CSV with a header and one line per point; the columns' names contain their units.
[[nodiscard]] std::string trade_csv(const std::vector<TradePoint>& points, const governor::ParetoFront& front);

/// Plot of error against time and against bytes: a curve for each setting, and the Pareto front.
[[nodiscard]] std::string trade_svg(const std::vector<TradePoint>& points, const governor::ParetoFront& front,
                                    const std::string& title);

}  // namespace cyclorama
