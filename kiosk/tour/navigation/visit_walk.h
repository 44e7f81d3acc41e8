// SPDX-License-Identifier: Apache-2.0
/// The complete state that decides where a visitor stands and looks, as one value that events change. The same events
/// give the same walk, bit by bit; a recording is based on this (walk_record.h).
///
///   VisitWalk ── event, time ──► VisitWalk        no clock, no thread, no device, nothing random
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <variant>

#include "kiosk/tour/navigation/navigator.h"
#include "kiosk/tour/navigation/wand_choice.h"

namespace cyclorama::tour {

/// A scene became available, for the first time or again.
struct SceneOpened {
  std::string name;
  Site site;
};
/// A tracker processed a picture. The pose is unchecked.
struct PoseSeen {
  std::uint64_t tracker = 0;
  std::uint64_t sequence = 0;
  std::int64_t shutter_ns = 0;
  bool found = false;
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{};  ///< w, x, y, z.
  bool body = false;                 ///< True for a visitor without a tag (body_steering.h).
};
struct TrackerLeft {
  std::uint64_t tracker = 0;
};
struct KeysPressed {
  SteeringCommand command;
};
/// The visitor is to be led to a stop.
struct LedToStop {
  std::size_t stop = 0;
};
/// The picture was cut to a stop.
struct CutToStop {
  std::size_t stop = 0;
};
/// From now on, until the scene opens again, only kept pictures of stops can be shown.
struct Held {};
/// Time passed.
struct Tick {};
using WalkEvent = std::variant<SceneOpened, PoseSeen, TrackerLeft, KeysPressed, LedToStop, CutToStop, Held, Tick>;

/// A value.
struct VisitWalk {
  std::string scene;
  Site site;
  bool open = false;  ///< False before the first scene, when nobody walks.
  Navigation navigation;
  WandSelector choice;
  std::map<std::uint64_t, PoseOrder> trackers;
};

/// Returns the event that brings the visitor to a stop. Precondition: can_go_to().
[[nodiscard]] WalkEvent way_to(const VisitWalk& walk, std::size_t stop);
/// True if the walk has such a stop, and an area to stand in.
[[nodiscard]] bool can_go_to(const VisitWalk& walk, std::size_t stop);
/// Returns the stop that is `step` stops after the one that the visitor reached last, is led to, or stands at; the
/// nearest one if there is none. After the last comes the first. Nothing without stops.
[[nodiscard]] std::optional<std::size_t> stop_after(const VisitWalk& walk, int step);

/// Returns the walk after `event`, which arrived at `at`. If the same scene opens again, the position is kept as far as
/// the walkable area still allows it.
[[nodiscard]] VisitWalk after(VisitWalk walk, const WalkEvent& event, TimePoint at, const NavigationSettings& settings);

/// Returns the pose, or nothing if it is not a rigid transform.
[[nodiscard]] std::optional<RigidTransform<frame::Camera, frame::Tag>> tag_pose_of(const PoseSeen& seen);

}  // namespace cyclorama::tour
