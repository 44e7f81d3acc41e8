// SPDX-License-Identifier: Apache-2.0
/// All that decides where a visitor stands and looks, as one value that events change. Whoever has the events has the
/// walk, bit by bit: that is what a recording is (walk_record.h).
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

namespace cyclorama {

/// A scene is there, for the first time or again.
struct SceneOpened {
  std::string name;
  Site site;
};
/// A tracker looked at a picture. The pose as it came, unchecked.
struct PoseSeen {
  std::uint64_t tracker = 0;
  std::uint64_t sequence = 0;
  std::int64_t shutter_ns = 0;
  bool found = false;
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation{};  ///< w, x, y, z.
  bool body = false;                 ///< A visitor without a pattern (body_steering.h).
};
struct TrackerLeft {
  std::uint64_t tracker = 0;
};
struct KeysPressed {
  SteeringWish wish;
};
/// Time passed.
struct Tick {};
using WalkEvent = std::variant<SceneOpened, PoseSeen, TrackerLeft, KeysPressed, Tick>;

/// A value.
struct VisitWalk {
  std::string scene;
  Site site;
  bool open = false;  ///< False before the first scene: nobody walks.
  Navigation navigation;
  WandChoice choice;
  std::map<std::uint64_t, PictureOrder> trackers;
};

/// The walk after `event`, which arrived at `at`. The same scene again keeps the place, as far as it is still allowed.
[[nodiscard]] VisitWalk after(VisitWalk walk, const WalkEvent& event, TimePoint at, const NavigationSettings& settings);

/// What is no rigid transform gives nothing.
[[nodiscard]] std::optional<RigidTransform<frame::Camera, frame::Tag>> tag_pose_of(const PoseSeen& seen);

}  // namespace cyclorama
