// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/channel_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/photometry/monotone_curve.h"

namespace cyclorama::photometry {
namespace {

constexpr int kSteps = 1024;
/// Light that varies by less than this fraction of full scale is flat: half a step of an 8-bit code at a gamma of 2.2.
constexpr double kFlat = 0.004;
constexpr double kFlatBelow = 0.97;  // A flat part that begins at a higher code is harmless.
constexpr double kDark = 0.001;
constexpr double kDarkAbove = 0.2;  // A gamma of 4 gives a light of 0.0016 here.
constexpr double kFall = 0.003;

/// Returns the power that makes the curve nearly straight, so that its interpolation is accurate.
double straightening_power(std::span<const ResponsePoint> points) {
  double xx = 0.0;
  double xy = 0.0;
  for (const ResponsePoint& point : points) {
    if (!(point.level > 0.05 && point.level < 0.95 && point.light > std::max(0.01, 3.0 * point.sigma))) continue;
    const double x = std::log(point.level);
    xx += x * x;
    xy += x * std::log(std::min(point.light, 1.0));
  }
  return xx > 0.0 ? std::clamp(xy / xx, 0.5, 5.0) : 2.2;
}

/// Adds the point, between two others, at which the light stops increasing; it is extrapolated from the slope before
/// it.
void add_kink(std::vector<ResponsePoint>* points, ChannelResponse* response) {
  std::size_t flat = points->size() - 1;
  while (flat > 0 && (*points)[flat - 1].light >= 1.0 - std::max(kFlat, 3.0 * (*points)[flat - 1].sigma)) --flat;
  const bool is_flat = flat + 1 < points->size() && flat >= 2 && (*points)[flat].level < kFlatBelow;
  if (!is_flat) return;
  const ResponsePoint& a = (*points)[flat - 2];
  const ResponsePoint& b = (*points)[flat - 1];
  const double slope = (b.light - a.light) / (b.level - a.level);
  const double kink = slope > 0.0 ? b.level + (1.0 - b.light) / slope : (*points)[flat].level;
  response->flat_above = std::clamp(kink, b.level, (*points)[flat].level);
  if (kink > b.level + 1e-3 && kink < (*points)[flat].level - 1e-3)
    points->insert(points->begin() + static_cast<std::ptrdiff_t>(flat), {kink, 1.0, b.sigma});
}

}  // namespace

double ChannelResponse::light_of(double level) const {
  const double at = std::clamp(level, 0.0, 1.0) * static_cast<double>(light.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), light.size() - 2);
  const double along = at - static_cast<double>(first);
  return (1.0 - along) * light[first] + along * light[first + 1];
}

warp::ResponseCurve ChannelResponse::inverse(std::size_t steps) const {
  warp::ResponseCurve curve;
  curve.codes.reserve(steps);
  std::size_t i = 0;
  double code = 0.0;
  for (std::size_t step = 0; step < steps; ++step) {
    const double root = static_cast<double>(step) / static_cast<double>(steps - 1);
    // The largest light is slightly below 1, since an asymptotic curve never reaches 1.
    const double wanted = std::min(root * root, 1.0 - 1e-9);
    while (i + 1 < light.size() && light[i + 1] < wanted) ++i;
    if (i + 1 < light.size() && wanted > 0.0) {
      const double rise = light[i + 1] - light[i];
      const double along = rise > 0.0 ? std::clamp((wanted - light[i]) / rise, 0.0, 1.0) : 1.0;
      code = std::max(code, (static_cast<double>(i) + along) / static_cast<double>(light.size() - 1));
    }
    curve.codes.push_back(static_cast<float>(code));
  }
  return curve;
}

Result<ChannelResponse> channel_response(std::span<const ResponsePoint> measured) {
  std::vector<ResponsePoint> points(measured.begin(), measured.end());
  const bool is_whole = points.size() >= 3 && points.front().level == 0.0 && points.back().level == 1.0;
  const bool rises = std::ranges::adjacent_find(
                         points, [](const auto& a, const auto& b) { return !(a.level < b.level); }) == points.end();
  if (!is_whole || !rises) {
    return Error(ErrorCode::kInvalidArgument,
                 "a response needs three levels or more, from black to full; photograph the whole ramp");
  }
  double max = 0.0;
  for (const ResponsePoint& point : points) {
    if (!std::isfinite(point.light) || !(point.sigma >= 0.0))
      return Error(ErrorCode::kInvalidArgument, "a level without light; photograph the ramp again");
    max = std::max(max, point.light);
  }
  if (!(max > 0.0)) {
    return Error(ErrorCode::kInvalidArgument,
                 "no level of the ramp shines; look whether the projector is on and its lens open");
  }
  ChannelResponse response;
  double variance = 0.0;
  for (ResponsePoint& point : points) {
    point.light = std::clamp(point.light / max, 0.0, 1.0);
    point.sigma /= max;
    variance += point.sigma * point.sigma;
  }
  points.front().light = 0.0;
  response.sigma = std::sqrt(variance / static_cast<double>(points.size()));
  add_kink(&points, &response);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ResponsePoint& a = points[i - 1];
    const ResponsePoint& b = points[i];
    const double sigma = std::hypot(a.sigma, b.sigma);
    if (!response.falls_at && b.light < a.light - std::max(kFall, 4.0 * sigma)) response.falls_at = a.level;
    if (b.level >= kDarkAbove && b.light + 2.0 * b.sigma < kDark) response.dark_below = b.level;
  }
  const double power = straightening_power(points);
  std::vector<double> levels;
  std::vector<double> straight;
  for (const ResponsePoint& point : points) {
    levels.push_back(point.level);
    straight.push_back(std::pow(point.light, 1.0 / power));
  }
  const MonotoneCurve curve(std::move(levels), std::move(straight));
  double brightest = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double light = std::pow(std::max(0.0, curve.at(static_cast<double>(i) / kSteps)), power);
    response.light.push_back(light);
    brightest = std::max(brightest, light);
  }
  for (double& light : response.light) light /= brightest;
  return response;
}

std::vector<std::string> remarks_on(const ChannelResponse& response, const std::string& whose) {
  std::vector<std::string> remarks;
  if (response.flat_above) {
    remarks.push_back(
        fmt::format("{}: code values above {:.0f} % shine no brighter; lower the projector's contrast or "
                    "turn off its dynamic modes, then calibrate again",
                    whose, 100.0 * *response.flat_above));
  }
  if (response.dark_below) {
    remarks.push_back(
        fmt::format("{}: code values below {:.0f} % stay black; raise the projector's brightness setting, "
                    "and look whether it expects limited range (16 to 235), then calibrate again",
                    whose, 100.0 * *response.dark_below));
  }
  if (response.falls_at) {
    remarks.push_back(
        fmt::format("{}: above {:.0f} % it gets darker with growing code values for a while; choose "
                    "another picture mode of the projector, then calibrate again (until then the falling "
                    "codes are not used)",
                    whose, 100.0 * *response.falls_at));
  }
  return remarks;
}

}  // namespace cyclorama::photometry
