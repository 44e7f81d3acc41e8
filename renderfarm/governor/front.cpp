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

namespace {

/// Minimum scale for which the samples between two points are rounded up.
constexpr double kSharp = 0.7;
constexpr double kTiny = 1e-9;

double area_of(const ParetoPoint& point) { return point.quality.scale * point.quality.scale; }

}  // namespace

ParetoPoint ParetoFront::at(double cost) const {
  const auto next = std::ranges::find_if(points_, [&](const ParetoPoint& point) { return point.cost > cost; });
  if (next == points_.begin()) return points_.front();
  if (next == points_.end()) return points_.back();
  const ParetoPoint& below = *std::prev(next);
  const ParetoPoint& above = *next;
  const double part = (cost - below.cost) / (above.cost - below.cost);
  const auto between = [&](double from, double to) { return std::lerp(from, to, part); };
  const auto samples_of = [](const ParetoPoint& point) { return static_cast<double>(point.quality.render.samples); };
  // Cost of one sample of a rendered pixel, from which the affordable number of samples follows.
  const double unit =
      between(below.cost / (area_of(below) * samples_of(below)), above.cost / (area_of(above) * samples_of(above)));
  const auto [fewest, most] = std::minmax({samples_of(below), samples_of(above)});
  const double wanted_samples = std::clamp(cost / (unit * between(area_of(below), area_of(above))), fewest, most);
  const double wanted_area = cost / (unit * wanted_samples);
  ParetoPoint point = above.error * above.cost <= below.error * cost ? above : below;
  double samples = std::ceil(wanted_samples - kTiny);
  if (wanted_area * wanted_samples < kSharp * kSharp * samples) samples = std::floor(wanted_samples + kTiny);
  const double area = std::min(1.0, wanted_area * wanted_samples / samples);
  point.quality.render.samples = static_cast<int>(samples);
  point.quality.scale = std::clamp(std::sqrt(area), render::kMinScale, 1.0);
  point.cost = std::min(cost, unit * samples * area_of(point));
  point.error = between(below.error, above.error);
  return point;
}

ParetoFront ParetoFront::standard(int bounces) {
  // Measured with cyclorama-bench-render trade GROTTO --size 320x120 --reference-samples 512, for the generated grotto
  // of 1 M triangles with 4 bounces; the faster of two runs. A point is kept if its relMSE and its FLIP are both
  // smaller than those of all cheaper points, and if it does not have more samples and fewer pixels than another row (2
  // at 0.35, 4 at 0.71), because sharpness matters more. One sample at full size is omitted: its relMSE is larger than
  // that of one sample at 0.71, and it costs more than two samples at 0.71. Denoising helps up to 16 samples; the last
  // row has twice the cost of 64 samples. With other numbers of bounces, mainly the unit of the costs differs.
  struct Row {
    double scale;
    int samples;
    bool denoise;
    double cpu_us_per_px;
    double relmse;
  };
  constexpr Row kRows[] = {
      {0.35, 1, true, 0.254, 0.0869}, {0.5, 1, true, 0.591, 0.0485},  {0.71, 1, true, 0.965, 0.0316},
      {0.71, 2, true, 1.722, 0.0197}, {1.0, 2, true, 3.594, 0.0134},  {1.0, 4, true, 6.507, 0.0059},
      {1.0, 8, true, 15.08, 0.0032},  {1.0, 16, true, 24.44, 0.0017}, {1.0, 128, false, 232.0, 0.0014}};
  std::vector<ParetoPoint> points;
  for (const Row& row : kRows) {
    ParetoPoint point;
    point.quality.scale = row.scale;
    point.quality.denoise = row.denoise;
    point.quality.render.samples = row.samples;
    point.quality.render.bounces = bounces;
    point.cost = row.cpu_us_per_px;
    point.error = row.relmse;
    points.push_back(point);
  }
  return *make(std::move(points));
}

}  // namespace cyclorama::governor
