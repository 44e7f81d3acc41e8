// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/body_follower.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::tracker {
namespace {

constexpr double kMinHeadM = 0.13;
constexpr double kMaxHeadM = 0.18;
constexpr double kMaxUprightRad = 0.14;
constexpr Duration kKept = std::chrono::milliseconds(400);
constexpr Duration kRemembered = std::chrono::seconds(2);
/// Maximum speed of a walking or bending person.
constexpr double kMaxSpeedMPerS = 2.5;
constexpr double kMaxSpeedRadPerS = 2.5;
/// Maximum motion of an arriving person who counts as standing still.
constexpr double kStillM = 0.09;
constexpr double kStillRad = 0.12;
constexpr double kMaxLeanRad = 0.7;
/// Factor from which a chest that is wider than on arrival belongs to two people.
constexpr double kMerged = 1.3;
/// Factor by which a lean that cannot be measured fades in each picture.
constexpr double kFades = 0.95;
/// Distance from the middle of the head's rows down to the hip, in head widths.
constexpr double kHeadToHip = 4.6;

double spread(const auto& values, const auto& of) {
  const auto [min, max] =
      std::minmax_element(values.begin(), values.end(), [&](const auto& a, const auto& b) { return of(a) < of(b); });
  return of(*max) - of(*min);
}
double mean(const auto& values, const auto& of) {
  double sum = 0.0;
  for (const auto& value : values) sum += of(value);
  return sum / static_cast<double>(values.size());
}

CellBounds region_of(const BodyShape& shape, const Pinhole& lens) {
  const HeadCandidate& head = shape.head;
  const double middle = 0.5 * (head.u + shape.hip_u);
  const double half = 2.3 * head.width + 0.5 * std::abs(head.u - shape.hip_u);
  return {static_cast<int>(std::floor(middle - half)), static_cast<int>(std::floor(head.top - 0.6 * head.width)),
          static_cast<int>(std::ceil(middle + half)), lens.height_px};
}

}  // namespace

void BodyFollower::Filtered::follow(double measured, double max, double seconds, double rest_hz, double hz_per_speed) {
  if (seconds <= 0.0) return;
  const auto weight = [seconds](double hz) { return 1.0 - std::exp(-2.0 * std::numbers::pi * hz * seconds); };
  const double off = std::clamp(measured - value, -max, max);
  speed += weight(1.0) * (off / seconds - speed);
  value += weight(rest_hz + hz_per_speed * std::abs(speed)) * off;
}

BodyFollower::Standing BodyFollower::standing(const BodyShape& shape, const Pinhole& lens, TimePoint at) const {
  Standing now;
  now.at = at;
  double width = shape.head.width;
  now.deviation = shape.width_deviation / shape.head.width;
  now.chest = shape.chest_width / shape.head.width;
  now.lean_rad = shape.lean_rad;
  double hip_u = shape.hip_u;
  if (chest_ > 0.0 && (!shape.has_chest || now.chest > kMerged * chest_)) {
    // In the picture, a person behind has merged with the chest: only the head surely belongs to the visitor, and the
    // lean fades.
    now.lean_rad = kFades * lean_.value + upright_rad_;
    hip_u = shape.head.u + std::tan(now.lean_rad) * kHeadToHip * width;
  } else if (chest_ > 0.0) {
    // Combines two measures of depth. The chest has less weight, since it is narrower when turned and wider with an
    // arm. If the two measures contradict each other, one of them has merged with a background of the same grey: the
    // one that is nearer to the expected depth is used.
    const double by_chest = shape.chest_width / chest_;
    const double head_sure = 1.0 / (now.deviation * now.deviation + 4e-4);
    const double off = shape.chest_width_deviation / shape.chest_width;
    const double chest_sure = 1.0 / (off * off + 25e-4);
    if (std::abs(std::log(by_chest / width)) < 0.12) {
      width = (head_sure * width + chest_sure * by_chest) / (head_sure + chest_sure);
    } else {
      const double expected = head_m_ * lens.focal_px / depth_.value;
      if (std::abs(std::log(by_chest / expected)) < std::abs(std::log(width / expected))) width = by_chest;
      now.deviation = std::max(now.deviation, 0.08);
    }
  }
  now.width = width / lens.focal_px;
  now.depth_m = head_m_ / now.width;
  now.x_m = (hip_u - lens.centre_u_px) / lens.focal_px * now.depth_m;
  return now;
}

void BodyFollower::forget() {
  phase_ = BodyPhase::kNobody;
  region_.reset();
  arriving_.clear();
  head_m_ = kHeadM;
  upright_rad_ = 0.0;
  chest_ = 0.0;
}

std::optional<BodyPose> BodyFollower::miss(TimePoint at) {
  shape_.reset();
  if (phase_ == BodyPhase::kArriving) forget();
  if (phase_ == BodyPhase::kFollowed && (at - seen_at_ > kRemembered || at < seen_at_)) forget();
  return std::nullopt;
}

bool BodyFollower::is_possible(const Standing& now) const {
  const double seconds = std::max(0.02, to_seconds(now.at - seen_at_));
  const double steps = kMaxSpeedMPerS * std::min(seconds, 0.4);
  return std::abs(now.x_m - x_.value) < 0.15 + steps && std::abs(now.depth_m - depth_.value) < 0.25 + steps &&
         std::abs(now.lean_rad - upright_rad_ - lean_.value) < 0.25 + kMaxSpeedRadPerS * std::min(seconds, 0.4) &&
         std::abs(now.lean_rad) < kMaxLeanRad;
}

std::optional<BodyPose> BodyFollower::update(const Silhouette& silhouette, const Pinhole& lens, TimePoint at) {
  if (silhouette.light != LightState::kSteady) return miss(at);
  const SummedShare share(silhouette.share);
  if (phase_ == BodyPhase::kFollowed && shape_) {
    const auto position = find_head_near(share, shape_->head);
    const auto shape = position ? measured(silhouette, *position) : std::nullopt;
    if (shape && is_possible(standing(*shape, lens, at))) return follow(*shape, lens, at);
  }
  const double nearest = std::max(0.4, settings_.mark_distance_m - settings_.follow_radius_m);
  const double farthest = settings_.mark_distance_m + settings_.follow_radius_m;
  std::optional<BodyShape> best;
  double best_away = 1e9;
  for (const HeadCandidate& position :
       find_heads(share, kMinHeadM * lens.focal_px / farthest, kMaxHeadM * lens.focal_px / nearest)) {
    const auto shape = measured(silhouette, position);
    if (!shape || shape->outline <= 0.0) continue;  // The outline is a ghost's.
    if (!shape->has_chest && phase_ != BodyPhase::kFollowed) continue;
    const Standing now = standing(*shape, lens, at);
    if (now.depth_m < nearest || now.depth_m > farthest || std::abs(now.x_m) > settings_.follow_radius_m) continue;
    if (phase_ == BodyPhase::kFollowed && !is_possible(now)) continue;
    const double to_x = phase_ == BodyPhase::kNobody     ? 0.0
                        : phase_ == BodyPhase::kFollowed ? x_.value
                                                         : arriving_.back().x_m;
    const double to_depth = phase_ == BodyPhase::kNobody     ? settings_.mark_distance_m
                            : phase_ == BodyPhase::kFollowed ? depth_.value
                                                             : arriving_.back().depth_m;
    const double away = std::hypot(now.x_m - to_x, now.depth_m - to_depth);
    if (away < best_away) best = shape, best_away = away;
  }
  if (!best) return miss(at);
  return phase_ == BodyPhase::kFollowed ? follow(*best, lens, at) : arrive(*best, lens, at);
}

std::optional<BodyPose> BodyFollower::arrive(const BodyShape& shape, const Pinhole& lens, TimePoint at) {
  shape_ = shape;
  const Standing now = standing(shape, lens, at);
  if (std::hypot(now.x_m, now.depth_m - settings_.mark_distance_m) > settings_.begin_within_m) {
    forget();
    return std::nullopt;
  }
  phase_ = BodyPhase::kArriving;
  region_ = region_of(shape, lens);
  if (!arriving_.empty() && at <= arriving_.back().at) return std::nullopt;
  arriving_.push_back(now);
  const auto x = [](const Standing& s) { return s.x_m; };
  const auto lean = [](const Standing& s) { return s.lean_rad; };
  const auto width = [](const Standing& s) { return s.width; };
  while (arriving_.size() > 1 && arriving_.back().at - arriving_[1].at >= settings_.begins_after)
    arriving_.erase(arriving_.begin());
  if (arriving_.back().at - arriving_.front().at < settings_.begins_after || arriving_.size() < 5) return std::nullopt;
  const double mean_width = mean(arriving_, width);
  const bool still = spread(arriving_, x) < kStillM && spread(arriving_, lean) < kStillRad &&
                     spread(arriving_, width) < 0.2 * mean_width;
  if (!still) return std::nullopt;
  head_m_ = std::clamp(mean_width * settings_.mark_distance_m, kMinHeadM, kMaxHeadM);
  upright_rad_ = std::clamp(mean(arriving_, lean), -kMaxUprightRad, kMaxUprightRad);
  const double chest = mean(arriving_, [](const Standing& s) { return s.chest; });
  arriving_.clear();
  phase_ = BodyPhase::kFollowed;
  const Standing begun = standing(shape, lens, at);
  x_.start(begun.x_m);
  depth_.start(begun.depth_m);
  lean_.start(begun.lean_rad - upright_rad_);
  chest_ = chest;
  seen_at_ = at;
  return follow(shape, lens, at);
}

std::optional<BodyPose> BodyFollower::follow(const BodyShape& shape, const Pinhole& lens, TimePoint at) {
  const Standing now = standing(shape, lens, at);
  if (std::abs(now.x_m) > settings_.follow_radius_m ||
      std::abs(now.depth_m - settings_.mark_distance_m) > settings_.follow_radius_m)
    return miss(at);
  const double seconds = to_seconds(at - seen_at_);
  if (seconds > to_seconds(kKept)) {  // The visitor was lost in between, so the filtered values are old.
    x_.start(now.x_m);
    depth_.start(now.depth_m);
    lean_.start(now.lean_rad - upright_rad_);
  }
  x_.follow(now.x_m, 0.15, seconds, 1.5, 12.0);
  depth_.follow(now.depth_m, 0.12, seconds, 1.0, 4.0);
  lean_.follow(now.lean_rad - upright_rad_, 0.15, seconds, 1.2, 10.0);
  seen_at_ = at;
  shape_ = shape;
  region_ = region_of(shape, lens);
  BodyPose pose{x_.value, depth_.value, lean_.value, 0.0, 0.0, shape.lean_deviation};
  pose.depth_deviation_m = now.depth_m * now.deviation;
  pose.x_deviation_m =
      std::hypot(shape.hip_deviation / lens.focal_px * now.depth_m, now.x_m / now.depth_m * pose.depth_deviation_m);
  return pose;
}

}  // namespace cyclorama::tracker
