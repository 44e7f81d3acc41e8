// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama {

Result<Front> Front::make(std::vector<FrontPoint> points) {
  for (const FrontPoint& point : points) {
    TRY(validate(point.quality));
    if (!(point.cost > 0.0 && std::isfinite(point.cost) && point.error >= 0.0 && std::isfinite(point.error))) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("a point costs {} and has an error of {}; the cost must be above 0, the error not below",
                               point.cost, point.error));
    }
  }
  std::ranges::sort(points, {}, [](const FrontPoint& point) { return std::pair(point.cost, point.error); });
  std::vector<FrontPoint> kept;
  for (FrontPoint& point : points) {
    if (kept.empty() || point.error < kept.back().error) kept.push_back(std::move(point));
  }
  if (kept.empty()) return Error(ErrorCode::kInvalidArgument, "a front without points leaves no choice");
  return Front(std::move(kept));
}

Front Front::standard() {
  // Samples with one bounce at half, three quarters and full size. The costs count pixels x samples x path vertices,
  // and for a pixel's way through JPEG, network and display as much as a tenth of a sample; errors are a pixel's
  // variance over its samples, and what a smaller size blurs.
  struct Row {
    double scale;
    int samples;
  };
  constexpr Row kRows[] = {{0.5, 1}, {0.75, 1}, {1.0, 1},  {1.0, 2},  {1.0, 4},
                           {1.0, 8}, {1.0, 16}, {1.0, 32}, {1.0, 64}, {1.0, 128}};
  constexpr double kCostOfSending = 0.2;
  constexpr double kBlur = 2.0;
  std::vector<FrontPoint> points;
  for (const Row& row : kRows) {
    FrontPoint point;
    point.quality.scale = row.scale;
    point.quality.render.samples = row.samples;
    point.quality.render.bounces = 1;
    point.cost = row.scale * row.scale * (2.0 * row.samples + kCostOfSending);
    point.error = 1.0 / row.samples + kBlur * (1.0 - row.scale);
    points.push_back(point);
  }
  return *make(std::move(points));
}

}  // namespace cyclorama
