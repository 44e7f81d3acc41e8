// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama::governor {

Result<ParetoFront> ParetoFront::make(std::vector<ParetoPoint> points) {
  for (const ParetoPoint& point : points) {
    TRY(render::validate(point.quality));
    if (!(point.cost > 0.0 && std::isfinite(point.cost) && point.error >= 0.0 && std::isfinite(point.error))) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("a point costs {} and has an error of {}; the cost must be above 0, the error not below",
                               point.cost, point.error));
    }
  }
  std::ranges::sort(points, {}, [](const ParetoPoint& point) { return std::pair(point.cost, point.error); });
  std::vector<ParetoPoint> kept;
  for (ParetoPoint& point : points) {
    if (kept.empty() || point.error < kept.back().error) kept.push_back(std::move(point));
  }
  if (kept.empty()) return Error(ErrorCode::kInvalidArgument, "a front without points leaves no choice");
  return ParetoFront(std::move(kept));
}

ParetoFront ParetoFront::standard() {
  // Measured with cyclorama-bench-render trade GROTTO --size 320x120 --reference-samples 512, for the generated grotto of
  // 1 M triangles; the quicker of two runs. Points are kept if both their relMSE and their FLIP are smaller than those of
  // all cheaper points. Denoising is beneficial up to 16 samples.
  struct Row {
    double scale;
    int samples;
    int bounces;
    bool denoise;
    double cpu_us_per_px;
    double relmse;
  };
  constexpr Row kRows[] = {
      {0.35, 1, 0, true, 0.08, 0.0682}, {0.35, 1, 1, true, 0.33, 0.0602},   {0.5, 1, 1, true, 0.57, 0.0374},
      {0.5, 2, 1, true, 1.03, 0.0263},  {0.5, 4, 1, true, 2.02, 0.0199},    {0.71, 2, 4, true, 3.35, 0.0166},
      {1.0, 2, 4, true, 6.95, 0.0111},  {1.0, 4, 4, true, 14.5, 0.0049},    {1.0, 8, 4, true, 26.9, 0.0025},
      {1.0, 16, 4, true, 46.7, 0.0013}, {1.0, 128, 4, false, 371.0, 0.0006}};
  std::vector<ParetoPoint> points;
  for (const Row& row : kRows) {
    ParetoPoint point;
    point.quality.scale = row.scale;
    point.quality.denoise = row.denoise;
    point.quality.render.samples = row.samples;
    point.quality.render.bounces = row.bounces;
    point.cost = row.cpu_us_per_px;
    point.error = row.relmse;
    points.push_back(point);
  }
  return *make(std::move(points));
}

}  // namespace cyclorama::governor
