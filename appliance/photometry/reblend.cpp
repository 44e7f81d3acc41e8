// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/reblend.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "appliance/photometry/make_heads.h"

namespace cyclorama::photometry {
namespace {

// Maximum change of the logarithm: a displacement does not make an area seven times as bright.
constexpr double kMaxChange = 2.0;

/// Returns the area of the wall that a pixel lights, in square metres, projected towards the sweet spot.
std::optional<double> lit_area(const calibration::MeasuredMap& map, const Eigen::Vector2d& pixel,
                               const std::function<double(const Eigen::Vector3d&)>& inverse_depth) {
  const double step = std::min(16.0, 0.02 * std::min(map.width_px, map.height_px));
  const auto position = [&](const Eigen::Vector2d& at) -> std::optional<Eigen::Vector3d> {
    const auto d = map.direction_at(at);
    if (!d) return std::nullopt;
    const double near = inverse_depth(*d);
    if (!(near > 0.0)) return std::nullopt;
    return *d / near;
  };
  const Eigen::Vector2d middle(std::clamp(pixel.x(), step, map.width_px - step),
                               std::clamp(pixel.y(), step, map.height_px - step));
  const auto left = position(middle - Eigen::Vector2d(step, 0.0));
  const auto right = position(middle + Eigen::Vector2d(step, 0.0));
  const auto above = position(middle - Eigen::Vector2d(0.0, step));
  const auto below = position(middle + Eigen::Vector2d(0.0, step));
  if (!left || !right || !above || !below) return std::nullopt;
  const double area = (*right - *left).cross(*below - *above).norm() / (4.0 * step * step);
  if (!(area > 0.0) || !std::isfinite(area)) return std::nullopt;
  return area;
}

}  // namespace

void move_light(const calibration::MeasuredMap& before, const calibration::MeasuredMap& after,
                const std::function<double(const Eigen::Vector3d&)>& inverse_depth, ProjectorLighting* light) {
  PictureField& white = light->log_white;
  double lowest = 0.0;
  double highest = 0.0;
  for (int y = 0; y < white.cells_y + 3; ++y) {
    for (int x = 0; x < white.cells_x + 3; ++x) {
      // A coefficient of a cubic spline is about the spline's value where the coefficient's basis function is largest.
      const Eigen::Vector2d pixel(
          std::clamp((x - 1.0) * white.width_px / white.cells_x, 0.0, static_cast<double>(white.width_px)),
          std::clamp((y - 1.0) * white.height_px / white.cells_y, 0.0, static_cast<double>(white.height_px)));
      const auto then = lit_area(before, pixel, inverse_depth);
      const auto now = lit_area(after, pixel, inverse_depth);
      if (!then || !now) continue;
      const double change = std::clamp(std::log(*then / *now), -kMaxChange, kMaxChange);
      lowest = std::min(lowest, change);
      highest = std::max(highest, change);
      const auto at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(white.cells_x + 3) + static_cast<std::size_t>(x);
      white.coefficients[at] += change;
    }
  }
  white.min += lowest;
  white.max += highest;
}

Result<Photometry> reblended(const std::vector<PhotometricProjector>& projectors, const WallLighting& light,
                             std::span<const calibration::CalibratedColour> before, const PhotometryOptions& options) {
  bool fits = before.size() == projectors.size() && light.projectors.size() == projectors.size() && !projectors.empty();
  for (std::size_t p = 0; fits && p < projectors.size(); ++p) {
    const PictureField& white = light.projectors[p].log_white;
    fits = before[p].name == projectors[p].name && white.width_px == projectors[p].map.width_px &&
           white.height_px == projectors[p].map.height_px;
  }
  if (!fits) {
    return Error(ErrorCode::kInvalidArgument,
                 "maps, light and colours are not of the same projectors; take all of one calibration");
  }
  PhotometryInput input;
  input.projectors = projectors;
  std::vector<InverseMap> inverses;
  std::vector<std::string> names;
  std::vector<Eigen::Matrix3d> primaries;
  bool has_colour = true;
  Photometry result;
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    auto inverse = InverseMap::make(projectors[p].map);
    if (!inverse) return std::move(inverse).error().while_doing(fmt::format("projector '{}'", projectors[p].name));
    inverses.push_back(*std::move(inverse));
    names.push_back(projectors[p].name);
    primaries.push_back(light.projectors[p].primaries);
    has_colour = has_colour && before[p].colour.matrix.has_value();
    result.heads.emplace_back().colour.response = before[p].colour.response;
  }
  std::optional<CommonGamut> gamut;
  if (has_colour) {
    TRY_ASSIGN(gamut, common_gamut(primaries, kCameraLuminance, names));
  }
  const BlendWeights weights(input.projectors, inverses);
  TRY(make_heads(input, options, light, weights, gamut ? &*gamut : nullptr, &result));
  return result;
}

}  // namespace cyclorama::photometry
