// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/outline.h"

#include <algorithm>
#include <array>

namespace cyclorama::scene {
namespace {

double distance_to_line(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const double t = edge.squaredNorm() > 0.0 ? std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * edge).norm();
}

// Directions +x, +z, -x, -z. A step of a border from a corner runs between a cell in the set (kIn) and a cell outside
// it (kOut).
constexpr std::array<std::array<int, 2>, 4> kStep = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr std::array<std::array<int, 2>, 4> kIn = {{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
constexpr std::array<std::array<int, 2>, 4> kOut = {{{0, -1}, {0, 0}, {-1, 0}, {-1, -1}}};

}  // namespace

CellSet reached_from(const CellSet& set, int start_x, int start_z) {
  CellSet reached(set.width(), set.depth());
  std::vector<std::pair<int, int>> waiting;
  const auto reach = [&](int x, int z) {
    if (!set.has(x, z) || reached.has(x, z)) return;
    reached.add(x, z);
    waiting.emplace_back(x, z);
  };
  reach(start_x, start_z);
  while (!waiting.empty()) {
    const auto [x, z] = waiting.back();
    waiting.pop_back();
    reach(x - 1, z);
    reach(x + 1, z);
    reach(x, z - 1);
    reach(x, z + 1);
  }
  return reached;
}

std::vector<std::vector<Eigen::Vector2i>> borders_of(const CellSet& set) {
  const auto is_edge = [&](const Eigen::Vector2i& at, std::size_t d) {
    return set.has(at.x() + kIn[d][0], at.y() + kIn[d][1]) && !set.has(at.x() + kOut[d][0], at.y() + kOut[d][1]);
  };
  // Every border has a step along +x above a cell of the set whose upper neighbour is outside; each such step belongs
  // to one border.
  CellSet walked(set.width(), set.depth());
  std::vector<std::vector<Eigen::Vector2i>> borders;
  for (int z = 0; z < set.depth(); ++z) {
    for (int x = 0; x < set.width(); ++x) {
      if (walked.has(x, z) || !is_edge({x, z}, 0)) continue;
      std::vector<Eigen::Vector2i>& corners = borders.emplace_back();
      const Eigen::Vector2i first(x, z);
      Eigen::Vector2i at = first;
      std::size_t direction = 0;
      do {
        if (direction == 0) walked.add(at.x(), at.y());
        corners.push_back(at);
        at += Eigen::Vector2i(kStep[direction][0], kStep[direction][1]);
        // Turning around the current cell first separates cells that touch only at a corner.
        for (const std::size_t turn : {std::size_t{1}, std::size_t{0}, std::size_t{3}}) {
          if (!is_edge(at, (direction + turn) % 4)) continue;
          direction = (direction + turn) % 4;
          break;
        }
      } while (at != first || direction != 0);
    }
  }
  return borders;
}

std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& corners, double tolerance) {
  const std::size_t n = corners.size();
  std::vector<bool> kept(n, false);
  std::size_t opposite = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if ((corners[i] - corners[0]).norm() > (corners[opposite] - corners[0]).norm()) opposite = i;
  }
  kept[0] = kept[opposite] = true;
  std::vector<std::pair<std::size_t, std::size_t>> waiting = {{0, opposite}, {opposite, n}};
  while (!waiting.empty()) {
    const auto [begin, end] = waiting.back();
    waiting.pop_back();
    double farthest = tolerance;
    std::size_t at = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double distance = distance_to_line(corners[i], corners[begin], corners[end % n]);
      if (distance > farthest) farthest = distance, at = i;
    }
    if (at == begin) continue;
    kept[at] = true;
    waiting.emplace_back(begin, at);
    waiting.emplace_back(at, end);
  }
  std::vector<Eigen::Vector2d> simple;
  for (std::size_t i = 0; i < n; ++i) {
    if (kept[i]) simple.push_back(corners[i]);
  }
  return simple;
}

}  // namespace cyclorama::scene
