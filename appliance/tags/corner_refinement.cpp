// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/corner_refinement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace cyclorama::tags {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kPointsPerSide = 32;
/// Share of a side that is not sampled at each end, where the adjacent side's edge blurs it.
constexpr double kKeepClearOfCorners = 0.08;
constexpr double kStepPx = 0.25;
constexpr double kMaxRadiusPx = 3.0;
constexpr double kMinRadiusPx = 0.75;
/// Distance from an edge within which its step, blurred over two pixels, is complete.
constexpr double kBlurPx = 1.25;
/// Minimum contrast of a step from black to white; less counts as noise.
constexpr double kMinContrastGrey = 12.0;
constexpr double kMaxMovePx = 2.0;
/// Share of a normal distribution's variance that its middle three quarters have.
constexpr double kTrimmedShare = 0.369;
/// Minimum deviation of a step's position, however well the points agree, since neighbouring points share pixels.
constexpr double kMinDeviationPx = 0.02;

/// Interpolates bilinearly between pixel centres, of which the first is at (0.5, 0.5); empty outside of them.
std::optional<double> grey_at(const GreyImage& picture, const Vector2d& position) {
  const double x = position.x() - 0.5;
  const double y = position.y() - 0.5;
  if (!(x >= 0.0 && y >= 0.0 && x < picture.width() - 1 && y < picture.height() - 1)) return std::nullopt;
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const double u = x - left;
  const double v = y - top;
  const std::uint8_t* const upper = picture.at(left, top);
  const std::uint8_t* const lower = picture.at(left, top + 1);
  return (1.0 - v) * ((1.0 - u) * upper[0] + u * upper[1]) + v * ((1.0 - u) * lower[0] + u * lower[1]);
}

struct EdgePoint {
  Vector2d position;
  double weight;
};

/// Returns the step from black to white along a line across the side through `middle`; empty if there is none.
std::optional<EdgePoint> find_step(const GreyImage& picture, const Vector2d& middle, const Vector2d& to_white,
                                   double radius_px) {
  const int steps = static_cast<int>(radius_px / kStepPx);
  double moment = 0.0;
  double rise = 0.0;
  std::optional<double> last;
  for (int i = -steps; i <= steps; ++i) {
    const auto grey = grey_at(picture, middle + i * kStepPx * to_white);
    if (!grey) return std::nullopt;
    // A falling step belongs to another edge.
    if (last && *grey > *last) {
      moment += (*grey - *last) * (i - 0.5) * kStepPx;
      rise += *grey - *last;
    }
    last = grey;
  }
  if (rise < kMinContrastGrey) return std::nullopt;
  return EdgePoint{middle + (moment / rise) * to_white, rise};
}

/// A fitted line. Its variances are across it, in px²: `variance` at `point`, and the contribution `turn_variance` of
/// the uncertain angle per squared distance from `point`.
struct Line {
  Vector2d point;
  Vector2d direction;
  double variance = TagDetection::kUnrefined(0, 0);
  double turn_variance = 0.0;

  [[nodiscard]] Vector2d normal() const { return {direction.y(), -direction.x()}; }
  [[nodiscard]] double variance_at(const Vector2d& position) const {
    const double along = (position - point).dot(direction);
    return variance + turn_variance * along * along;
  }
};

Line fit(const std::vector<EdgePoint>& points) {
  Vector2d mean = Vector2d::Zero();
  double sum = 0.0;
  for (const EdgePoint& point : points) {
    mean += point.weight * point.position;
    sum += point.weight;
  }
  mean /= sum;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const EdgePoint& point : points) {
    const Vector2d d = point.position - mean;
    xx += point.weight * d.x() * d.x();
    xy += point.weight * d.x() * d.y();
    yy += point.weight * d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {mean, {std::cos(angle), std::sin(angle)}, 0.0, 0.0};
}

double distance(const Line& line, const Vector2d& point) {
  const Vector2d d = point - line.point;
  return std::abs(d.x() * line.direction.y() - d.y() * line.direction.x());
}

/// Sets the variances of `line` from the points that it was fitted to, the best three quarters of all.
void set_variance(const std::vector<EdgePoint>& points, double length_px, Line* line) {
  double across = 0.0;
  double along = 0.0;
  for (const EdgePoint& point : points) {
    const Vector2d d = point.position - line->point;
    across += std::pow(d.dot(line->normal()), 2);
    along += std::pow(d.dot(line->direction), 2);
  }
  const auto count = static_cast<double>(points.size());
  const double each = std::max(across / (count * kTrimmedShare), kMinDeviationPx * kMinDeviationPx);
  // Points less than a pixel apart sample the same pixels.
  const double independent = std::max(2.0, std::min(count, length_px * count / kPointsPerSide));
  line->variance = each / independent;
  line->turn_variance = each / (independent * std::max(along / count, 1e-6));
}

/// Fits a line to the side between two corners; `thickness_px` is the distance to the opposite side.
Line side_of(const GreyImage& picture, const Vector2d& from, const Vector2d& to, double thickness_px, int cells_across,
             TagBorder border) {
  const Line unchanged{from, (to - from).normalized()};
  const Vector2d outwards = unchanged.normal();  // Corners run clockwise in the picture.
  const Vector2d to_white = border == TagBorder::kBlack ? outwards : Vector2d(-outwards);
  // Half a cell; more for a small tag, so that the whole blurred step is included, but no neighbouring cells of the
  // code.
  const double cell_px = thickness_px / cells_across;
  const double radius_px = std::min(kMaxRadiusPx, std::max(0.5 * cell_px, std::min(0.9 * cell_px, kBlurPx)));
  if (!(radius_px >= kMinRadiusPx)) return unchanged;
  std::vector<EdgePoint> points;
  for (int i = 0; i < kPointsPerSide; ++i) {
    const double t = kKeepClearOfCorners + (1.0 - 2.0 * kKeepClearOfCorners) * (i + 0.5) / kPointsPerSide;
    if (const auto point = find_step(picture, from + t * (to - from), to_white, radius_px)) points.push_back(*point);
  }
  if (points.size() < kPointsPerSide / 2) return unchanged;
  Line line = fit(points);
  // A finger or a reflection on the edge biases the fit, so it is repeated without the worst quarter.
  std::sort(points.begin(), points.end(), [&](const EdgePoint& a, const EdgePoint& b) {
    return distance(line, a.position) < distance(line, b.position);
  });
  points.resize(points.size() * 3 / 4);
  line = fit(points);
  set_variance(points, (to - from).norm(), &line);
  return line;
}

std::optional<Vector2d> crossing(const Line& a, const Line& b) {
  const double determinant = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (!(std::abs(determinant) > 0.05)) return std::nullopt;
  const Vector2d d = b.point - a.point;
  const double along = (d.x() * b.direction.y() - d.y() * b.direction.x()) / determinant;
  return Vector2d(a.point + along * a.direction);
}

/// Returns the covariance of an intersection: each line is uncertain along its normal, by its variance at the corner.
Matrix2d covariance_at(const Vector2d& corner, const Line& a, const Line& b) {
  Matrix2d normals;
  normals << a.normal().transpose(), b.normal().transpose();
  const Matrix2d inverse = normals.inverse();
  return inverse * Vector2d(a.variance_at(corner), b.variance_at(corner)).asDiagonal() * inverse.transpose();
}

}  // namespace

RefinedCorners refine_corners(const GreyImage& picture, const std::array<Vector2d, 4>& corners, int cells_across,
                              TagBorder border) {
  constexpr auto& kUnrefined = TagDetection::kUnrefined;
  const RefinedCorners unrefined{corners, {kUnrefined, kUnrefined, kUnrefined, kUnrefined}};
  std::array<Line, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& from = corners[i];
    const Vector2d& to = corners[(i + 1) % 4];
    const Vector2d opposite = 0.5 * (corners[(i + 2) % 4] + corners[(i + 3) % 4]);
    sides[i] = side_of(picture, from, to, distance({from, (to - from).normalized()}, opposite), cells_across, border);
  }
  RefinedCorners refined = unrefined;
  for (std::size_t i = 0; i < 4; ++i) {
    const Line& before = sides[(i + 3) % 4];
    const auto corner = crossing(before, sides[i]);
    if (!corner || !((*corner - corners[i]).norm() <= kMaxMovePx)) return unrefined;
    refined.positions[i] = *corner;
    const Matrix2d covariance = covariance_at(*corner, before, sides[i]);
    if (covariance.allFinite()) refined.covariance[i] = covariance;
  }
  return refined;
}

}  // namespace cyclorama::tags
