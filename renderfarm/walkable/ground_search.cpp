// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/ground_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "renderfarm/scene/area.h"

namespace cyclorama::walkable {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr int kRings = 8;             // Number of heights at which horizontal rays are traced.
constexpr double kMinRadiusM = 0.05;  // Minimum clearance, for an eye at 1.6 m.
constexpr double kSlopeSpanM = 0.6;
constexpr int kMaxCells = 2048;            // Along each side of the grid.
constexpr std::size_t kMaxCorners = 1000;  // Less than the maximum that navigation accepts.
constexpr double kMinHoleCells = 4.0;      // Minimum area of a hole, in cells.
constexpr std::array<std::array<int, 2>, 4> kBeside = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr double kNowhere = -std::numeric_limits<double>::infinity();

/// A grid of cells around the start, with the state of each cell.
class Ground {
 public:
  Ground(const RayProbe& probe, const scene::SceneInfo& info, const BodySize& body, double floor, double cell,
         int half_cells)
      : probe_(probe),
        body_(body),
        eye_y_(info.start_eye.y()),
        floor_(floor),
        cell_(cell),
        size_(2 * half_cells + 1),
        min_(Vector2d(info.start_eye.x(), info.start_eye.z()).array() - (half_cells + 0.5) * cell),
        heights_(count(), kNowhere),
        state_(count(), kUnknown) {}

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const Vector2d& min() const { return min_; }
  [[nodiscard]] bool contains(const Vector2i& c) const {
    return c.x() >= 0 && c.y() >= 0 && c.x() < size_ && c.y() < size_;
  }
  [[nodiscard]] Vector2d centre_of(const Vector2i& c) const {
    return min_ + cell_ * (c.cast<double>().array() + 0.5).matrix();
  }
  /// Traces rays down in those cells that have not been probed yet.
  void look_down(const std::vector<Vector2i>& cells);
  /// Returns the height found by look_down(); kNowhere if there is no ground, and outside the grid.
  [[nodiscard]] double seen_height(const Vector2i& c) const {
    return contains(c) && state_[index_of(c)] == kGround ? heights_[index_of(c)] : kNowhere;
  }
  [[nodiscard]] bool is_known(const Vector2i& c) const { return !contains(c) || state_[index_of(c)] != kUnknown; }
  /// Returns the height of the cell's ground; for a small gap, the mean of both sides.
  [[nodiscard]] double height(const Vector2i& c) const;
  [[nodiscard]] bool is_clear(const Vector2i& c, double height, double radius) const;
  [[nodiscard]] bool is_steep(const Vector2i& c) const;
  [[nodiscard]] int gap_cells() const { return std::max(1, static_cast<int>(body_.gap_m / cell_ + 0.5)); }

 private:
  enum State : std::uint8_t { kUnknown, kGap, kCovered, kGround };
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_); }
  [[nodiscard]] std::size_t index_of(const Vector2i& c) const {
    return static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(c.x());
  }

  const RayProbe& probe_;
  const BodySize body_;
  const double eye_y_;
  const double floor_;
  const double cell_;
  const int size_;
  const Vector2d min_;
  std::vector<double> heights_;
  std::vector<std::uint8_t> state_;
};

void Ground::look_down(const std::vector<Vector2i>& cells) {
  std::vector<Vector2i> batch;
  const auto look = [&] {
    std::vector<Vector2d> places;
    for (const Vector2i& c : batch) places.push_back(centre_of(c));
    // Rays start at the top of the headroom, so that the first surface is either the ground or an obstacle above it.
    const auto heights = probe_.heights(places, eye_y_ + body_.headroom_m, floor_ - body_.lower_m);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const bool is_ground = std::isfinite(heights[i]) && heights[i] <= floor_ + body_.higher_m;
      state_[index_of(batch[i])] = is_ground ? kGround : std::isfinite(heights[i]) ? kCovered : kGap;
      heights_[index_of(batch[i])] = is_ground ? heights[i] : kNowhere;
    }
    batch.clear();
  };
  for (const Vector2i& c : cells) {
    if (is_known(c)) continue;
    state_[index_of(c)] = kCovered;  // Avoids duplicates in a batch.
    batch.push_back(c);
    if (batch.size() == RayProbe::kBatch) look();
  }
  if (!batch.empty()) look();
}

double Ground::height(const Vector2i& c) const {
  const double own = seen_height(c);
  if (std::isfinite(own) || !contains(c) || state_[index_of(c)] != kGap) return own;
  const int max = gap_cells() + 1;  // Distance, in cells, from ground to ground across the whole gap.
  for (const Vector2i& way : {Vector2i(1, 0), Vector2i(0, 1), Vector2i(1, 1), Vector2i(1, -1)}) {
    for (int back = 1; back < max; ++back) {
      const double one = seen_height(c - back * way);
      for (int forth = 1; forth <= max - back; ++forth) {
        const double other = seen_height(c + forth * way);
        if (std::isfinite(one) && std::isfinite(other) && std::abs(one - other) <= body_.step_m)
          return 0.5 * (one + other);
      }
    }
  }
  return kNowhere;
}

bool Ground::is_clear(const Vector2i& c, double height, double radius) const {
  const Vector2d centre = centre_of(c);
  const double low = height + body_.knee_m;
  const double high = eye_y_ + body_.headroom_m;
  for (int ring = 0; ring < kRings; ++ring) {
    const double y = low + (high - low) * ring / (kRings - 1);
    if (!probe_.is_clear_around({centre.x(), y, centre.y()}, radius)) return false;
  }
  // Horizontal bars may lie between two rings, but are visible from above.
  for (const double part : {1.0, 0.5}) {
    std::vector<Vector2d> places;
    for (int i = 0; i < RayProbe::kBatch; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + part) / RayProbe::kBatch;
      places.push_back(centre + part * radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
    for (const double y : probe_.heights(places, high, low)) {
      if (std::isfinite(y)) return false;
    }
  }
  return true;
}

bool Ground::is_steep(const Vector2i& c) const {
  const int span = std::max(1, static_cast<int>(0.5 * kSlopeSpanM * body_.eye_m / 1.6 / cell_ + 0.5));
  std::array<double, 2> slope{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Vector2i way = axis == 0 ? Vector2i(span, 0) : Vector2i(0, span);
    const double one = seen_height(c + way);
    const double other = seen_height(c - way);
    if (std::isfinite(one) && std::isfinite(other)) slope[axis] = (one - other) / (2.0 * span * cell_);
  }
  return std::hypot(slope[0], slope[1]) > std::tan(body_.steepest_rad);
}

BodySize scaled(const BodySize& body, double by) {
  return {body.eye_m * by,   body.radius_m * by, body.headroom_m * by, body.step_m * by, body.knee_m * by,
          body.lower_m * by, body.higher_m * by, body.gap_m * by,      body.steepest_rad};
}

/// Flood fill of the cells that a visitor reaches from the centre, ring by ring, so that downward rays form batches.
class Flood {
 public:
  Flood(Ground* ground, const BodySize& body, double radius)
      : ground_(*ground),
        body_(body),
        radius_(radius),
        size_(ground->size()),
        kinds_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_), GroundKind::kUnseen) {}

  void run(const Vector2i& start) {
    std::vector<Vector2i> edge{start};
    look_around(edge);
    kind(start) = GroundKind::kWalkable;
    while (!edge.empty()) {
      std::vector<Vector2i> next;
      look_around(edge);
      for (const Vector2i& from : edge) {
        for (const auto& [dx, dz] : kBeside) step(from, from + Vector2i(dx, dz), &next);
      }
      edge = std::move(next);
    }
  }
  [[nodiscard]] const std::vector<GroundKind>& kinds() const { return kinds_; }

 private:
  GroundKind& kind(const Vector2i& c) {
    return kinds_[static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(c.x())];
  }
  /// Probes all cells that height() and is_steep() read for the edge's neighbours.
  void look_around(const std::vector<Vector2i>& edge) {
    const int near = 1 + ground_.gap_cells();
    const int far = 1 + std::max(1, static_cast<int>(0.5 * kSlopeSpanM * body_.eye_m / 1.6 / cell() + 0.5));
    std::vector<Vector2i> cells;
    for (const Vector2i& c : edge) {
      for (int dz = -near; dz <= near; ++dz) {
        for (int dx = -near; dx <= near; ++dx) cells.push_back(c + Vector2i(dx, dz));
      }
      for (int i = -1; i <= 1; ++i) {
        for (int d = far - 2; d <= far; ++d) {
          for (const Vector2i& way : {Vector2i(d, i), Vector2i(-d, i), Vector2i(i, d), Vector2i(i, -d)})
            cells.push_back(c + way);
        }
      }
    }
    ground_.look_down(cells);
  }
  [[nodiscard]] double cell() const { return (ground_.centre_of({1, 0}) - ground_.centre_of({0, 0})).x(); }
  void step(const Vector2i& from, const Vector2i& to, std::vector<Vector2i>* next) {
    if (!ground_.contains(to)) return;
    GroundKind& there = kind(to);
    if (there != GroundKind::kUnseen && there != GroundKind::kSteep) return;
    const double height = ground_.height(to);
    if (!std::isfinite(height)) {
      there = GroundKind::kNone;
    } else if (std::abs(height - ground_.height(from)) > body_.step_m) {
      there = GroundKind::kSteep;  // This holds only from this side; another way may be less steep.
    } else if (ground_.is_steep(to)) {
      there = GroundKind::kSteep;
    } else if (!ground_.is_clear(to, height, radius_)) {
      there = GroundKind::kBlocked;
    } else {
      there = GroundKind::kWalkable;
      next->push_back(to);
    }
  }

  Ground& ground_;
  const BodySize body_;
  const double radius_;
  const int size_;
  std::vector<GroundKind> kinds_;
};

/// Converts the cells to polygons, simplified with increasing tolerance until they have few enough corners and the
/// start is still inside.
Status make_polygons(const scene::CellSet& cells, const Vector2d& min, double cell, const Vector2d& start,
                     WalkableGround* ret) {
  const auto borders = scene::borders_of(cells);
  for (double tolerance = 0.75; tolerance < 100.0; tolerance *= 1.5) {
    ret->outline.clear();
    ret->holes.clear();
    std::size_t corners = 0;
    for (const std::vector<Vector2i>& border : borders) {
      std::vector<Vector2d> exact;
      for (const Vector2i& c : border) exact.push_back(min + cell * c.cast<double>());
      std::vector<Vector2d> polygon = scene::simplified(exact, tolerance * cell);
      const bool is_outline = &border == &borders.front();
      if (!is_outline && (polygon.size() < 3 || scene::area_of(polygon) < kMinHoleCells * cell * cell)) continue;
      corners += polygon.size();
      if (is_outline) {
        ret->outline = std::move(polygon);
      } else {
        ret->holes.push_back(std::move(polygon));
      }
    }
    if (ret->outline.size() >= 3 && corners <= kMaxCorners && scene::is_inside(ret->outline, start) &&
        std::none_of(ret->holes.begin(), ret->holes.end(),
                     [&](const auto& hole) { return scene::is_inside(hole, start); }))
      return Done{};
  }
  return Error(
      ErrorCode::kInvalidArgument,
      "the ground around the start is too small or too ragged to walk on; move [start] eye_m to where there is "
      "room");
}

/// Returns the largest clearance, of those tried up to the body's radius, for which the start is clear.
Result<double> radius_at(const Ground& ground, const Vector2i& start, double floor, const BodySize& body) {
  for (double radius = body.radius_m; radius >= kMinRadiusM * body.eye_m / 1.6; radius *= 0.75) {
    if (ground.is_clear(start, floor, radius)) return radius;
  }
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("something is within {:.2f} m of the start, so nobody can stand there; move [start] eye_m",
                           kMinRadiusM * body.eye_m / 1.6));
}

}  // namespace

Result<WalkableGround> find_walkable(const RayProbe& probe, const scene::SceneInfo& info,
                                     const Eigen::AlignedBox3d& bounds, const GroundOptions& options) {
  const Eigen::Vector3d& eye = info.start_eye;
  constexpr double kMaxEyeHeights = 3.0;
  const auto below = probe.distance(eye, -Eigen::Vector3d::UnitY(), kMaxEyeHeights * info.eye_height_m);
  if (!below) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("there is no ground within {:.2f} m below the start at ({:.2f}, {:.2f}, {:.2f}); correct "
                             "[start] eye_m or [visitor] eye_height_m",
                             kMaxEyeHeights * info.eye_height_m, eye.x(), eye.y(), eye.z()));
  }
  if (*below < 0.5 * info.eye_height_m) {
    return Error(
        ErrorCode::kInvalidArgument,
        fmt::format("something lies {:.2f} m below the eye at the start, and the ground should be {:.2f} m below; "
                    "correct [start] eye_m or [visitor] eye_height_m",
                    *below, info.eye_height_m));
  }
  const double by = *below / BodySize{}.eye_m;
  const BodySize body = scaled({}, by);
  WalkableGround found;
  found.floor_m = eye.y() - *below;
  const double reach = std::min(options.reach_m * by, std::max(bounds.sizes().x(), bounds.sizes().z()) + 1.0 * by);
  found.cell_m = std::max(options.cell_m * by, 2.0 * reach / kMaxCells);
  const int half = static_cast<int>(std::ceil(reach / found.cell_m));
  Ground ground(probe, info, body, found.floor_m, found.cell_m, half);
  const Vector2i start(half, half);
  ground.look_down({start});
  if (!std::isfinite(ground.seen_height(start)))
    return Error(ErrorCode::kInvalidArgument,
                 "there is no room for a head at the start; move [start] eye_m, or lower [visitor] eye_height_m");
  TRY_ASSIGN(found.radius_m, radius_at(ground, start, found.floor_m, body));

  Flood flood(&ground, body, found.radius_m);
  flood.run(start);
  found.width = found.depth = ground.size();
  found.min = ground.min();
  found.kinds = flood.kinds();
  scene::CellSet cells(found.width, found.depth);
  for (int z = 0; z < found.depth; ++z) {
    for (int x = 0; x < found.width; ++x) {
      const auto index =
          static_cast<std::size_t>(z) * static_cast<std::size_t>(found.width) + static_cast<std::size_t>(x);
      if (found.kinds[index] != GroundKind::kWalkable) continue;
      cells.add(x, z);
      found.area_m2 += found.cell_m * found.cell_m;
    }
  }
  TRY(make_polygons(cells, found.min, found.cell_m, {eye.x(), eye.z()}, &found));
  return found;
}

}  // namespace cyclorama::walkable
