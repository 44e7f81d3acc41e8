// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "appliance/tracker/markerless/silhouette.h"
#include "common/base/clock.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

/// Where visitors stand who steer by their bodies, and how they are taken in.
struct BodySettings {
  double mark_distance_m = 2.0;  ///< From the camera to the mark on the floor where one begins.
  double follow_radius_m = 0.9;  ///< So far before, behind and beside the mark a visitor is followed.
  double begin_within_m = 0.5;   ///< So near to the mark one must come to rest to be taken in.
  Duration begins_after = std::chrono::milliseconds(900);  ///< Of standing still there.
};

enum class BodyPhase { kNobody, kArriving, kFollowed };

/// A visitor in one picture, in the Camera frame: x to its right, so the visitor's right is negative.
struct BodyPose {
  double x_m = 0.0;
  double depth_m = 0.0;
  double lean_rad = 0.0;  ///< From the posture on arrival; positive to the visitor's own right.
  double x_deviation_m = 0.0;
  double depth_deviation_m = 0.0;
  double lean_deviation_rad = 0.0;
};

/// Follows one visitor through silhouettes: who comes to rest at the mark is taken in, with head and posture as they
/// are then, and followed until lost; others before and behind are passed by.
///
///   nobody ──somebody near the mark──▶ arriving ──still for begins_after──▶ followed
///      ▲ ◄───────── walked on ────────────┘                                  │
///      └──────── not seen for 2 s, or beyond reach (seen before: goes on) ◄──┘
///
/// Heads differ by a tenth in width, so a width alone tells the depth to a tenth. Therefore the head of who comes to
/// rest is taken to be at the mark if that makes it a head of 0.13 to 0.18 m; from then on depth changes are told by
/// the head and, a second opinion, by the chest. Filtered (a critically damped follower per quantity, whose speed grows
/// with that of the visitor). A measurement that no body can have jumped to is not taken. Thread-bound; a function of
/// what it was given.
class BodyFollower {
 public:
  explicit BodyFollower(const BodySettings& settings) : settings_(settings) {}

  /// `lens` is of the cells. Nothing when nobody is followed in this picture.
  std::optional<BodyPose> update(const Silhouette& silhouette, const Pinhole& lens, TimePoint at);
  [[nodiscard]] BodyPhase phase() const { return phase_; }
  /// Where the visitor is, or was a moment ago: the room must not be learned there.
  [[nodiscard]] const std::optional<CellBounds>& region() const { return region_; }
  /// Of the newest picture, in cells, for people to look at.
  [[nodiscard]] const std::optional<BodyShape>& shape() const { return shape_; }

 private:
  /// One quantity, filtered.
  struct Filtered {
    double value = 0.0;
    double speed = 0.0;
    void start(double at) { *this = {at, 0.0}; }
    /// Of what is farther off than `most`, no more than that is believed.
    void follow(double measured, double max, double seconds, double rest_hz, double hz_per_speed);
  };
  struct Standing {
    TimePoint at{};
    double x_m = 0.0;
    double depth_m = 0.0;
    double width = 0.0;      ///< Of the head, over the focal length.
    double deviation = 0.0;  ///< Of it, as part of it.
    double chest = 0.0;      ///< Its width over the head's.
    double lean_rad = 0.0;
  };
  std::optional<BodyPose> arrive(const BodyShape& shape, const Pinhole& lens, TimePoint at);
  std::optional<BodyPose> follow(const BodyShape& shape, const Pinhole& lens, TimePoint at);
  [[nodiscard]] Standing standing(const BodyShape& shape, const Pinhole& lens, TimePoint at) const;
  [[nodiscard]] bool is_possible(const Standing& now) const;
  std::optional<BodyPose> miss(TimePoint at);
  void forget();

  /// Of an adult's head; a child of six has 0.145.
  static constexpr double kHeadM = 0.155;
  BodySettings settings_;
  BodyPhase phase_ = BodyPhase::kNobody;
  std::optional<CellBounds> region_;
  std::optional<BodyShape> shape_;
  std::vector<Standing> arriving_;
  double head_m_ = kHeadM;
  double upright_rad_ = 0.0;
  double chest_ = 0.0;  ///< Of the visitor: the chest's width over the head's; 0 while it is not known.
  Filtered x_, depth_, lean_;
  TimePoint seen_at_{};
};

}  // namespace cyclorama::tracker
