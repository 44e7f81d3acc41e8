// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/cut_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace cyclorama::warp {
namespace {

using Line = Eigen::Hyperplane<double, 2>;
using Polygon = std::vector<std::uint32_t>;  ///< A convex polygon, as indices of its corners.

constexpr double kOnLine_px = 1e-6;

class Cutter {
 public:
  explicit Cutter(std::vector<Eigen::Vector2d>* positions) : positions_(*positions) {}

  /// Returns the parts of `polygon` on either side; one of them is empty if the line does not cut it.
  std::pair<Polygon, Polygon> split(const Polygon& polygon, const Line& line) {
    std::pair<Polygon, Polygon> parts;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const std::uint32_t here = polygon[i];
      const std::uint32_t next = polygon[(i + 1) % polygon.size()];
      const double a = side(line, here);
      const double b = side(line, next);
      if (a >= 0.0) parts.first.push_back(here);
      if (a <= 0.0) parts.second.push_back(here);
      if (a * b >= 0.0) continue;
      const std::uint32_t cut = cut_between(line, here, next);
      parts.first.push_back(cut);
      parts.second.push_back(cut);
    }
    // A part that only touches the line has no area on the other side.
    if (parts.first.size() < 3) parts.first.clear();
    if (parts.second.size() < 3) parts.second.clear();
    return parts;
  }

  /// Triangulates the polygon around its middle, so that none of its corners is skipped.
  void triangulate(const Polygon& polygon, std::vector<std::uint32_t>* corners) {
    if (polygon.size() == 3) {
      corners->insert(corners->end(), polygon.begin(), polygon.end());
      return;
    }
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const std::uint32_t corner : polygon) sum += positions_[corner];
    const auto middle = static_cast<std::uint32_t>(positions_.size());
    positions_.push_back(sum / static_cast<double>(polygon.size()));
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      corners->insert(corners->end(), {middle, polygon[i], polygon[(i + 1) % polygon.size()]});
    }
  }

 private:
  [[nodiscard]] double side(const Line& line, std::uint32_t vertex) const {
    const double distance = line.signedDistance(positions_[vertex]);
    return std::abs(distance) <= kOnLine_px ? 0.0 : distance;
  }

  std::uint32_t cut_between(const Line& line, std::uint32_t from, std::uint32_t to) {
    const auto key = [&](std::uint32_t v) { return std::pair(positions_[v].x(), positions_[v].y()); };
    if (key(to) < key(from)) std::swap(from, to);  // Both neighbouring cells thus compute in the same order.
    const double a = line.signedDistance(positions_[from]);
    const double b = line.signedDistance(positions_[to]);
    const Eigen::Vector2d position = positions_[from] + a / (a - b) * (positions_[to] - positions_[from]);
    const auto known =
        cuts_.emplace(std::pair(position.x(), position.y()), static_cast<std::uint32_t>(positions_.size()));
    if (known.second) positions_.push_back(position);
    return known.first->second;
  }

  std::vector<Eigen::Vector2d>& positions_;
  std::map<std::pair<double, double>, std::uint32_t> cuts_;
};

}  // namespace

CutGrid cut_grid(const Eigen::Vector2d& size_px, int cells_x, int cells_y, const std::vector<Line>& lines) {
  CutGrid grid;
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i)
      grid.positions.emplace_back(size_px.x() * i / cells_x, size_px.y() * j / cells_y);
  }
  Cutter cutter(&grid.positions);
  const auto row = static_cast<std::uint32_t>(cells_x + 1);
  for (int cell = 0; !lines.empty() && cell < cells_x * cells_y; ++cell) {
    const std::uint32_t corner =
        static_cast<std::uint32_t>(cell / cells_x) * row + static_cast<std::uint32_t>(cell % cells_x);
    std::vector<Polygon> parts{{corner, corner + row, corner + row + 1, corner + 1}};
    for (const Line& line : lines) {
      std::vector<Polygon> finer;
      for (Polygon& part : parts) {
        auto [one, other] = cutter.split(part, line);
        if (one.empty() || other.empty()) {
          finer.push_back(std::move(part));
        } else {
          finer.push_back(std::move(one));
          finer.push_back(std::move(other));
        }
      }
      parts = std::move(finer);
    }
    if (parts.size() == 1) continue;
    CutCell cut{cell, {}};
    for (const Polygon& part : parts) cutter.triangulate(part, &cut.corners);
    grid.cuts.push_back(std::move(cut));
  }
  return grid;
}

}  // namespace cyclorama::warp
