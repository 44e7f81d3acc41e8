// SPDX-License-Identifier: Apache-2.0
/// Walks through a scene as visitors take them, by the tour's own navigation.
#pragma once

#include <string>
#include <vector>

#include "kiosk/tour/navigation/prediction.h"

namespace cyclorama {

struct WalkPose {
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
};

enum class WalkKind {
  kAhead,     ///< Straight ahead.
  kSideways,  ///< Past what is beside the visitor.
  kTurn,      ///< Ahead, then to the right: the direction changes by a right angle within half a second.
};
[[nodiscard]] const char* to_text(WalkKind kind);

/// The visitor's pose at each refresh, and the poses for which the tour would ask for pictures.
class WalkedPath {
 public:
  /// Starts at rest at the site's start; keys are pressed from the first refresh on.
  WalkedPath(const tour::Site& site, double eye_height_m, WalkKind kind, double refresh_hz, int refreshes);

  [[nodiscard]] int refreshes() const { return static_cast<int>(walks_.size()); }
  [[nodiscard]] WalkPose at(int refresh) const;
  /// The pose that the tour expects `ahead_s` after a refresh, if the present input holds.
  [[nodiscard]] WalkPose predicted(int refresh, double ahead_s) const;
  [[nodiscard]] WalkKind kind() const { return kind_; }
  /// Metres from the first pose to the last.
  [[nodiscard]] double length_m() const;

 private:
  [[nodiscard]] WalkPose pose_of(const tour::Walker& walker) const;

  WalkKind kind_;
  double eye_height_m_;
  double period_s_;
  tour::NavigationSettings settings_;
  std::vector<tour::VisitWalk> walks_;
  std::vector<TimePoint> times_;
};

}  // namespace cyclorama
