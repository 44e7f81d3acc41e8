// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/slow_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace cyclorama::photometry {
namespace {

constexpr int kMaxGridPoints = 200000;
constexpr int kMargin = 2;  // In grid points.
constexpr int kMaxSweeps = 12;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Seen {
  Eigen::Vector3d direction;
};

/// Steps to the preceding neighbours in reading order; the opposite steps lead to the following neighbours. With these
/// sixteen directions a path over the grid is at most 2.7 % longer than the straight path.
constexpr std::array<std::pair<int, int>, 8> kBefore = {
    {{-1, 0}, {0, -1}, {-1, -1}, {1, -1}, {-2, -1}, {2, -1}, {-1, -2}, {1, -2}}};

/// Returns the angle between unit vectors; accurate for small angles too.
double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return 2.0 * std::asin(0.5 * (a - b).norm()); }

}  // namespace

DirectionField::DirectionField(const calibration::DirectionChart& chart, const Eigen::Vector2d& low, double step,
                               int columns, int rows)
    : chart_(chart), low_(low), step_rad_(step), columns_(columns), rows_(rows) {
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      // Grid points outside the chart, far beyond everything lit, get the direction of the nearest point inside the
      // chart.
      Eigen::Vector2d position = low_ + step_rad_ * Eigen::Vector2d(x, y);
      if (position.norm() > 3.1) position *= 3.1 / position.norm();
      directions_.push_back(*chart_.direction_of(position));
    }
  }
  logs_.assign(directions_.size(), kInfinite);
}

Result<DirectionField> DirectionField::over(const std::vector<PhotometricProjector>& projectors, double step_rad) {
  std::vector<Seen> seen;
  for (const PhotometricProjector& projector : projectors) {
    for (const Eigen::Vector3d& d : projector.map.directions) {
      if (d.allFinite()) seen.push_back({d});
    }
  }
  if (seen.empty()) return Error(ErrorCode::kInvalidArgument, "no map has a direction; measure the maps first");
  std::optional<calibration::DirectionChart> chart = calibration::DirectionChart::around(seen);
  // If the maps surround the sweet spot, the chart is centred on the nadir or the zenith, if the opposite pole is
  // unlit.
  for (const double up : {-1.0, 1.0}) {
    if (chart) break;
    chart.emplace(Eigen::Vector3d(0.0, up, 0.0));
    const bool fits = std::ranges::all_of(seen, [up](const Seen& s) { return up * s.direction.y() > -0.97; });
    if (!fits) chart.reset();
  }
  if (!chart) {
    return Error(ErrorCode::kInvalidArgument,
                 "the projectors light all directions from the sweet spot, floor and zenith alike; leave one of them "
                 "out");
  }
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInfinite);
  Eigen::Vector2d high = -low;
  for (const Seen& s : seen) {
    const Eigen::Vector2d position = chart->place_of(s.direction).value_or(Eigen::Vector2d::Zero());
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  const Eigen::Vector2d size = high - low;
  double step = step_rad;
  step = std::max(step, std::sqrt(size.x() * size.y() / kMaxGridPoints));
  low -= Eigen::Vector2d::Constant(kMargin * step);
  const int columns = static_cast<int>(size.x() / step) + 2 + 2 * kMargin;
  const int rows = static_cast<int>(size.y() / step) + 2 + 2 * kMargin;
  return DirectionField(*chart, low, step, columns, rows);
}

void DirectionField::fill(const std::function<double(const Eigen::Vector3d&)>& value) {
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const double at = value(directions_[i]);
    logs_[i] = at > 0.0 && std::isfinite(at) ? std::log(at) : kInfinite;
  }
}

void DirectionField::sweep_cones(const std::vector<double>& slopes_per_rad) {
  bool is_changed = true;
  const auto relax = [&](int x, int y, int dx, int dy) {
    if (x + dx < 0 || x + dx >= columns_ || y + dy < 0 || y + dy >= rows_) return;
    const std::size_t here = index(x, y);
    const std::size_t there = index(x + dx, y + dy);
    if (!(logs_[there] < logs_[here])) return;
    const double slope_per_rad = 0.5 * (slopes_per_rad[here] + slopes_per_rad[there]);
    const double value = logs_[there] + slope_per_rad * angle(directions_[here], directions_[there]);
    if (!(value < logs_[here] - 1e-12)) return;
    logs_[here] = value;
    is_changed = true;
  };
  for (int sweep = 0; sweep < kMaxSweeps && is_changed; ++sweep) {
    is_changed = false;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        for (const auto& [dx, dy] : kBefore) relax(x, y, dx, dy);
      }
    }
    for (int y = rows_ - 1; y >= 0; --y) {
      for (int x = columns_ - 1; x >= 0; --x) {
        for (const auto& [dx, dy] : kBefore) relax(x, y, -dx, -dy);
      }
    }
  }
}

void DirectionField::blur(double sigma_cells) {
  const int peak = static_cast<int>(std::ceil(3.0 * sigma_cells));
  if (peak < 1) return;
  std::vector<double> kernel;
  double sum = 0.0;
  for (int i = -peak; i <= peak; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma_cells * sigma_cells)));
    sum += kernel.back();
  }
  std::vector<double> other(logs_.size());
  for (int axis = 0; axis < 2; ++axis) {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        double value = 0.0;
        for (int i = -peak; i <= peak; ++i) {
          const int xi = std::clamp(axis == 0 ? x + i : x, 0, columns_ - 1);
          const int yi = std::clamp(axis == 1 ? y + i : y, 0, rows_ - 1);
          value += kernel[static_cast<std::size_t>(i + peak)] * logs_[index(xi, yi)];
        }
        other[index(x, y)] = value / sum;
      }
    }
    std::swap(logs_, other);
  }
}

std::vector<bool> DirectionField::near_borders(const std::function<unsigned(const Eigen::Vector3d&)>& label,
                                               double radius_rad) const {
  std::vector<unsigned> labels;
  for (const Eigen::Vector3d& direction : directions_) labels.push_back(label(direction));
  std::vector<bool> is_near(labels.size(), false);
  const auto compare = [&](std::size_t a, std::size_t b) {
    if (labels[a] != 0 && labels[b] != 0 && labels[a] != labels[b]) is_near[a] = is_near[b] = true;
  };
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (x + 1 < columns_) compare(index(x, y), index(x + 1, y));
      if (y + 1 < rows_) compare(index(x, y), index(x, y + 1));
    }
  }
  // Marks a square of this half width around each marked point.
  const int peak = static_cast<int>(std::ceil(radius_rad / step_rad_));
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<bool> before = is_near;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        if (!before[index(x, y)]) continue;
        for (int i = -peak; i <= peak; ++i) {
          const int xi = std::clamp(axis == 0 ? x + i : x, 0, columns_ - 1);
          const int yi = std::clamp(axis == 1 ? y + i : y, 0, rows_ - 1);
          is_near[index(xi, yi)] = true;
        }
      }
    }
  }
  return is_near;
}

DirectionField DirectionField::slow_below(double slope_per_rad, double blur_rad) const {
  return slow_below(std::vector<double>(logs_.size(), slope_per_rad), blur_rad);
}

DirectionField DirectionField::slow_below(const std::vector<double>& slopes_per_rad, double blur_rad) const {
  DirectionField slow = *this;
  slow.sweep_cones(slopes_per_rad);
  slow.blur(blur_rad / step_rad_);
  double excess = 0.0;
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    if (std::isfinite(logs_[i])) excess = std::max(excess, slow.logs_[i] - logs_[i]);
  }
  for (double& log : slow.logs_) log -= excess;
  return slow;
}

double DirectionField::at(const Eigen::Vector3d& direction) const {
  const Eigen::Vector2d position = chart_.place_of(direction).value_or(Eigen::Vector2d::Zero());
  const Eigen::Vector2d at = (position - low_) / step_rad_;
  const double x = std::clamp(at.x(), 0.0, columns_ - 1.001);
  const double y = std::clamp(at.y(), 0.0, rows_ - 1.001);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const double fx = x - x0;
  const double fy = y - y0;
  return std::exp((1.0 - fy) * ((1.0 - fx) * logs_[index(x0, y0)] + fx * logs_[index(x0 + 1, y0)]) +
                  fy * ((1.0 - fx) * logs_[index(x0, y0 + 1)] + fx * logs_[index(x0 + 1, y0 + 1)]));
}

std::vector<DirectionField::Place> DirectionField::positions() const {
  std::vector<Place> result;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      const double radius = (low_ + step_rad_ * Eigen::Vector2d(x, y)).norm();
      const double shrink = radius < 1e-6 ? 1.0 : std::max(0.0, std::sin(std::min(radius, std::numbers::pi)) / radius);
      result.push_back({step_rad_ * step_rad_ * shrink, std::exp(logs_[index(x, y)])});
    }
  }
  return result;
}

}  // namespace cyclorama::photometry
