// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/walked_path.h"

namespace cyclorama {
namespace {
Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }
}  // namespace

const char* to_text(WalkKind kind) {
  switch (kind) {
    case WalkKind::kAhead:
      return "ahead";
    case WalkKind::kSideways:
      return "sideways";
    case WalkKind::kTurn:
      return "turn";
  }
  return "";
}

WalkedPath::WalkedPath(const tour::Site& site, double eye_height_m, WalkKind kind, double refresh_hz, int refreshes)
    : kind_(kind), eye_height_m_(eye_height_m), period_s_(1.0 / refresh_hz) {
  tour::VisitWalk walk;
  TimePoint now{};
  now += std::chrono::hours(1);
  walk = tour::after(walk, tour::SceneOpened{"scene", site}, now, settings_);
  for (int i = 0; i < refreshes; ++i) {
    const bool has_turned = kind == WalkKind::kTurn && i >= refreshes / 2;
    tour::SteeringCommand command;
    (kind == WalkKind::kSideways || has_turned ? command.right : command.forward) = 1.0;
    walk = tour::after(walk, tour::KeysPressed{command}, now, settings_);
    walk = tour::after(walk, tour::Tick{}, now, settings_);
    walks_.push_back(walk);
    times_.push_back(now);
    now += seconds(period_s_);
  }
}

WalkPose WalkedPath::pose_of(const tour::Walker& walker) const {
  return {{walker.position_m.x(), eye_height_m_, walker.position_m.y()}, walker.heading_rad};
}

WalkPose WalkedPath::at(int refresh) const {
  return pose_of(walks_[static_cast<std::size_t>(refresh)].navigation.walker);
}

WalkPose WalkedPath::predicted(int refresh, double ahead_s) const {
  const auto i = static_cast<std::size_t>(refresh);
  return pose_of(tour::predicted(walks_[i], times_[i] + seconds(ahead_s), settings_));
}

double WalkedPath::length_m() const { return (at(refreshes() - 1).eye_m - at(0).eye_m).norm(); }

}  // namespace cyclorama
