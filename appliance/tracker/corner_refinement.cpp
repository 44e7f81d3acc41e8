// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace cyclorama {
namespace {

using Eigen::Vector2d;

constexpr int kPointsPerSide = 32;
/// The ends of a side are blurred by the other side's edge.
constexpr double kKeepClearOfCorners = 0.08;
constexpr double kStepPx = 0.5;
constexpr double kMostReachPx = 3.0;
constexpr double kLeastReachPx = 1.0;
/// A step from black to white of less than this is noise.
constexpr double kLeastContrastGrey = 12.0;
constexpr double kMostMovePx = 2.0;

/// Bilinear, between pixel centres at (0.5, 0.5); nothing outside of them.
std::optional<double> grey_at(const GreyImage& picture, const Vector2d& place) {
  const double x = place.x() - 0.5;
  const double y = place.y() - 0.5;
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
  Vector2d place;
  double weight;
};

/// Where the step from inside (black) to outside (white) is on a line across the side.
std::optional<EdgePoint> find_step(const GreyImage& picture, const Vector2d& middle, const Vector2d& outwards,
                                   double reach_px) {
  const int steps = static_cast<int>(reach_px / kStepPx);
  double moment = 0.0;
  double rise = 0.0;
  std::optional<double> last;
  for (int i = -steps; i <= steps; ++i) {
    const auto grey = grey_at(picture, middle + i * kStepPx * outwards);
    if (!grey) return std::nullopt;
    // A fall is something else's edge.
    if (last && *grey > *last) {
      moment += (*grey - *last) * (i - 0.5) * kStepPx;
      rise += *grey - *last;
    }
    last = grey;
  }
  if (rise < kLeastContrastGrey) return std::nullopt;
  return EdgePoint{middle + (moment / rise) * outwards, rise};
}

/// A point of the line and its direction.
struct Line {
  Vector2d point;
  Vector2d direction;
};

Line fit(const std::vector<EdgePoint>& points) {
  Vector2d mean = Vector2d::Zero();
  double sum = 0.0;
  for (const EdgePoint& point : points) {
    mean += point.weight * point.place;
    sum += point.weight;
  }
  mean /= sum;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const EdgePoint& point : points) {
    const Vector2d d = point.place - mean;
    xx += point.weight * d.x() * d.x();
    xy += point.weight * d.x() * d.y();
    yy += point.weight * d.y() * d.y();
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {mean, {std::cos(angle), std::sin(angle)}};
}

double distance(const Line& line, const Vector2d& point) {
  const Vector2d d = point - line.point;
  return std::abs(d.x() * line.direction.y() - d.y() * line.direction.x());
}

Line side_of(const GreyImage& picture, const Vector2d& from, const Vector2d& to, int cells_across) {
  const Line unchanged{from, (to - from).normalized()};
  const Vector2d outwards(unchanged.direction.y(), -unchanged.direction.x());  // Corners go clockwise in the picture.
  // Half a cell, so that the code's own cells are not reached.
  const double reach_px = std::min(kMostReachPx, 0.5 * (to - from).norm() / cells_across);
  if (!(reach_px >= kLeastReachPx)) return unchanged;
  std::vector<EdgePoint> points;
  for (int i = 0; i < kPointsPerSide; ++i) {
    const double t = kKeepClearOfCorners + (1.0 - 2.0 * kKeepClearOfCorners) * (i + 0.5) / kPointsPerSide;
    if (const auto point = find_step(picture, from + t * (to - from), outwards, reach_px)) points.push_back(*point);
  }
  if (points.size() < kPointsPerSide / 2) return unchanged;
  Line line = fit(points);
  // A finger or a reflection on the edge pulls: once more without the worst quarter.
  std::sort(points.begin(), points.end(),
            [&](const EdgePoint& a, const EdgePoint& b) { return distance(line, a.place) < distance(line, b.place); });
  points.resize(points.size() * 3 / 4);
  line = fit(points);
  return line;
}

std::optional<Vector2d> crossing(const Line& a, const Line& b) {
  const double determinant = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (!(std::abs(determinant) > 0.05)) return std::nullopt;
  const Vector2d d = b.point - a.point;
  const double along = (d.x() * b.direction.y() - d.y() * b.direction.x()) / determinant;
  return Vector2d(a.point + along * a.direction);
}

}  // namespace

std::array<Vector2d, 4> refine_corners(const GreyImage& picture, const std::array<Vector2d, 4>& corners,
                                       int cells_across) {
  std::array<Line, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) sides[i] = side_of(picture, corners[i], corners[(i + 1) % 4], cells_across);
  std::array<Vector2d, 4> refined = corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = crossing(sides[(i + 3) % 4], sides[i]);
    if (!corner || !((*corner - corners[i]).norm() <= kMostMovePx)) return corners;
    refined[i] = *corner;
  }
  return refined;
}

}  // namespace cyclorama
