// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "appliance/tracker/markerless/silhouette.h"
#include "common/base/clock.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

/// Settings for visitors who steer by their bodies: where they stand, and when following starts.
struct BodySettings {
  double mark_distance_m = 2.0;  ///< Distance from the camera to the mark on the floor.
  double follow_radius_m = 0.9;  ///< A visitor is followed within this distance of the mark.
  double begin_within_m = 0.5;   ///< A visitor must come to rest within this distance of the mark.
  Duration begins_after = std::chrono::milliseconds(900);  ///< Time for which a visitor must stand still near the mark.
};

enum class BodyPhase { kNobody, kArriving, kFollowed };

/// A visitor in one picture, in the Camera frame: the camera's right is +x, so the visitor's right is -x.
struct BodyPose {
  double x_m = 0.0;
  double depth_m = 0.0;
  double lean_rad = 0.0;  ///< Relative to the posture on arrival; positive to the visitor's right.
  double x_deviation_m = 0.0;
  double depth_deviation_m = 0.0;
  double lean_deviation_rad = 0.0;
};

/// Follows one visitor through silhouettes: a person who comes to rest at the mark is followed until lost, with head
/// and posture at that moment as reference. Other people in front and behind are ignored.
///
///   nobody ──a person near the mark──▶ arriving ──still for begins_after──▶ followed
///      ▲ ◄───────── walked on ────────────┘                                  │
///      └──── not seen for 2 s, or beyond follow_radius_m (before that: kept) ◄┘
///
/// Heads differ by a tenth in width, so a width alone gives the depth only to a tenth. Therefore the head of a person
/// who comes to rest is assumed to be at the mark if its width is then 0.13 to 0.18 m; from then on, changes of depth
/// are measured by the head and, independently, by the chest. Each quantity is filtered by a critically damped
/// follower, whose cut-off rises with the visitor's speed. A measurement that implies an impossible jump is rejected.
/// Thread-bound; a pure function of its input.
class BodyFollower {
 public:
  explicit BodyFollower(const BodySettings& settings) : settings_(settings) {}

  /// Returns the pose of the followed visitor; empty if nobody is followed in this picture. `lens` is in units of
  /// cells.
  std::optional<BodyPose> update(const Silhouette& silhouette, const Pinhole& lens, TimePoint at);
  [[nodiscard]] BodyPhase phase() const { return phase_; }
  /// Region of the visitor, now or a moment ago; the background must not be learned there.
  [[nodiscard]] const std::optional<CellBounds>& region() const { return region_; }
  /// Shape of the visitor in the newest picture, in cells, for display.
  [[nodiscard]] const std::optional<BodyShape>& shape() const { return shape_; }

 private:
  /// One filtered quantity.
  struct Filtered {
    double value = 0.0;
    double speed = 0.0;
    void start(double at) { *this = {at, 0.0}; }
    /// Moves towards `measured`; a difference of more than `max` is clipped to `max`.
    void follow(double measured, double max, double seconds, double rest_hz, double hz_per_speed);
  };
  struct Standing {
    TimePoint at{};
    double x_m = 0.0;
    double depth_m = 0.0;
    double width = 0.0;      ///< Width of the head over the focal length.
    double deviation = 0.0;  ///< Relative deviation of `width`.
    double chest = 0.0;      ///< Ratio of the chest's width to the head's.
    double lean_rad = 0.0;
  };
  std::optional<BodyPose> arrive(const BodyShape& shape, const Pinhole& lens, TimePoint at);
  std::optional<BodyPose> follow(const BodyShape& shape, const Pinhole& lens, TimePoint at);
  [[nodiscard]] Standing standing(const BodyShape& shape, const Pinhole& lens, TimePoint at) const;
  [[nodiscard]] bool is_possible(const Standing& now) const;
  std::optional<BodyPose> miss(TimePoint at);
  void forget();

  /// Width of an adult's head in metres; a child of six has 0.145.
  static constexpr double kHeadM = 0.155;
  BodySettings settings_;
  BodyPhase phase_ = BodyPhase::kNobody;
  std::optional<CellBounds> region_;
  std::optional<BodyShape> shape_;
  std::vector<Standing> arriving_;
  double head_m_ = kHeadM;
  double upright_rad_ = 0.0;
  double chest_ = 0.0;  ///< Ratio of the visitor's chest width to the head's; 0 while it is not known.
  Filtered x_, depth_, lean_;
  TimePoint seen_at_{};
};

}  // namespace cyclorama::tracker
