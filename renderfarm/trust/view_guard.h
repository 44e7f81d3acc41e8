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

/// Refuses views that no visitor could have, so that a museum cannot scan a scene: the more pictures there are and the
/// freer their eyes, the better geometry can be reconstructed from them. One guard per session. A value; thread-bound.
///
/// An eye must be in the walkable area (or within kMarginM of it, which allows for rounding and predictions), at the
/// height of the start and the stops, and move at a walking pace. Only jumps to the start or to a stop of the scene may
/// be faster, and a jump elsewhere, as between stops of a museum's own tour, after a rest: it takes the whole reserve,
/// but no more, and shows no more places than a walk does in the same time.
/// Two eyes are at most as far apart as people's, and a pixel is no finer than an eye resolves.
class ViewGuard {
 public:
  explicit ViewGuard(const wire::SceneDescription& scene);

  /// Checks a view. Errors: kInvalidArgument, with the value and what is allowed.
  Status check(const wire::View& view, TimePoint now);

  static constexpr double kMarginM = 0.3;
  static constexpr double kHeightM = 1.0;          ///< Maximum distance above and below the start and the stops.
  static constexpr double kPaceMPerS = 2.0;        ///< Twice a tour's limit; multiplied by the scene's walking scale.
  static constexpr double kPaceReserveM = 4.0;     ///< Distance that a rest permits at once; multiplied likewise.
  static constexpr double kMaxEyeDistanceM = 1.0;  ///< Maximum distance between two eyes, as in installation.toml.
  static constexpr double kMaxPxPerRad = 20000.0;  ///< A 4K panel seen from 5 m; an eye resolves about 3400.

 private:
  using Point = std::array<double, 2>;  ///< Coordinates (x, z).
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

/// Counts the views and the distinct places of a museum on each day, for its quotas. Thread-bound.
class DailyViews {
 public:
  /// Limits per day; 0: not limited.
  struct Limits {
    std::int64_t views = 0;
    std::int64_t places = 0;
    friend bool operator==(const Limits&, const Limits&) = default;
  };
  /// Counts a view. Errors: kBusy, one sentence, if it would exceed a limit of its day. `day` counts days from any
  /// origin.
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
