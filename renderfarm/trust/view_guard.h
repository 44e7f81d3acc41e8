// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/token_bucket.h"
#include "common/wire/farm.pb.h"

namespace cyclorama::trust {

/// Refuses views that no visitor could have, so that a museum cannot scan a scene: pictures turn into geometry, the more
/// of them and the freer their eyes, the better. One session's; a value; thread-bound.
///
/// An eye is in the walkable area (or within kMarginM of it, for rounding and for predictions), at the height of the
/// start and of the stops, and moves at a walking pace; jumps lead to the start or to a stop. Two eyes are as far apart
/// as people's at most, and a pixel is no finer than an eye resolves.
class ViewGuard {
 public:
  explicit ViewGuard(const wire::SceneDescription& scene);

  /// Errors: kInvalidArgument, with the value and what is allowed.
  Status check(const wire::View& view, TimePoint now);

  static constexpr double kMarginM = 0.3;
  static constexpr double kHeightM = 1.0;          ///< Above and below the start and the stops.
  static constexpr double kPaceMPerS = 2.0;        ///< Twice a tour's own limit; times the scene's walking scale.
  static constexpr double kPaceReserveM = 4.0;     ///< May be walked at once after a rest; scaled likewise.
  static constexpr double kMaxEyeDistanceM = 1.0;  ///< Between two eyes: the limit of installation.toml.
  static constexpr double kMaxPxPerRad = 20000.0;  ///< A panel of 4K seen from 5 m; an eye resolves some 3400.

 private:
  using Point = std::array<double, 2>;  ///< (x, z).
  [[nodiscard]] bool is_walkable(const Point& eye) const;

  std::vector<Point> area_;
  std::vector<std::vector<Point>> holes_;
  std::vector<Point> jumps_;  ///< The start and the stops.
  double min_height_m_ = 0.0;
  double max_height_m_ = 0.0;
  double scale_ = 1.0;
  TokenBucket pace_;
  bool has_moved_ = false;
  Point last_{};
};

/// Counts a museum's views and distinct places of each day, for its quotas. Thread-bound.
class DailyViews {
 public:
  /// 0: not limited.
  struct Limits {
    std::int64_t views = 0;
    std::int64_t places = 0;
    friend bool operator==(const Limits&, const Limits&) = default;
  };
  /// Errors: kBusy, in one sentence, if the view would exceed a limit of its day. `day` counts days from any origin.
  Status count(const std::string& scene, const wire::View& view, const Limits& limits, std::int64_t day);

  [[nodiscard]] std::int64_t views() const { return views_; }
  [[nodiscard]] std::int64_t places() const { return static_cast<std::int64_t>(places_.size()); }

  static constexpr double kPlaceM = 0.25;  ///< Edge of the squares that count as one place.

 private:
  std::int64_t day_ = 0;
  std::int64_t views_ = 0;
  std::set<std::pair<std::string, std::array<std::int64_t, 2>>> places_;
};

}  // namespace cyclorama::trust
