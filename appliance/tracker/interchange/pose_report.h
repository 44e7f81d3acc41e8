// SPDX-License-Identifier: Apache-2.0
/// The common content of tracker protocols: a sensor's pose at a time. Cyclorama's own protocol uses wire::TrackedPose.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/geometry/rigid_transform.h"

namespace cyclorama::tracker {

/// A sensor's pose, with numbers as received; pose_of() checks them.
struct PoseReport {
  std::int32_t sensor = 0;  ///< Distinguishes several wands. In Cyclorama's reports: the tag's id.
  std::uint64_t sequence = 0;
  std::int64_t time_ns = 0;  ///< On the sender's clock.
  bool found = false;
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z.
  friend bool operator==(const PoseReport&, const PoseReport&) = default;
};

/// Axes of another tracker.
enum class TrackerAxes {
  kCamera,  ///< Axes of Cyclorama's camera, which is at the wall and faces the visitor: X right, Y down, Z forward.
  kRoom,    ///< X to the visitor's right, Y up, Z towards the visitor; origin at the wall, where a camera would be.
};

/// Returns the tag's pose in the Camera frame. A tag that is held straight has no rotation, whatever the axes of the
/// report. Empty if the tag was not found, or if the numbers are no pose.
[[nodiscard]] std::optional<RigidTransform<frame::Camera, frame::Tag>> pose_of(const PoseReport& report,
                                                                               TrackerAxes axes);

}  // namespace cyclorama::tracker
