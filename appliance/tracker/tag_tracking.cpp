// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_tracking.h"

#include <algorithm>

#include "appliance/tracker/wand_pose.h"
#include "common/wand/folded_card.h"

namespace cyclorama::tracker {
namespace {

struct SeenPattern {
  Wand wand;
  std::vector<tags::TagDetection> tags;
  double area_px2 = 0.0;
};

bool has_tag(const Wand& wand, int id) {
  return std::any_of(wand.tags.begin(), wand.tags.end(), [&](const WandTag& tag) { return tag.id == id; });
}

bool is_near(const tags::TagDetection& a, const tags::TagDetection& b) {
  // Distance between neighbours on one wand, at most, in sizes of the larger tag.
  constexpr double kFarSizes = 4.0;
  const double larger = std::max(tags::doubled_area_px2(a.corners), tags::doubled_area_px2(b.corners));
  return (a.corners[0] - b.corners[0]).squaredNorm() < kFarSizes * kFarSizes * 0.5 * larger;
}

/// Groups the detections by pattern. Patterns are in the order of their largest tags.
std::vector<SeenPattern> patterns_in(const PatternSettings& settings, std::span<const tags::TagDetection> detections) {
  std::vector<SeenPattern> patterns;
  for (const tags::TagDetection& detection : detections) {  // The largest tags come first.
    const auto known = std::find_if(patterns.begin(), patterns.end(), [&](const SeenPattern& pattern) {
      // Two cards with the same number are two patterns if they are far apart.
      return has_tag(pattern.wand, detection.id) && is_near(pattern.tags.front(), detection) &&
             std::none_of(pattern.tags.begin(), pattern.tags.end(),
                          [&](const tags::TagDetection& tag) { return tag.id == detection.id; });
    });
    SeenPattern* pattern = known == patterns.end() ? nullptr : &*known;
    if (pattern == nullptr) {
      auto wand = settings.pattern_of(detection.id);
      if (!wand) continue;
      pattern = &patterns.emplace_back(SeenPattern{*std::move(wand), {}, 0.0});
    }
    pattern->tags.push_back(detection);
    pattern->area_px2 += 0.5 * tags::doubled_area_px2(detection.corners);
  }
  std::stable_sort(patterns.begin(), patterns.end(),
                   [](const SeenPattern& a, const SeenPattern& b) { return a.area_px2 > b.area_px2; });
  return patterns;
}

/// Returns whether a visitor may steer by `chosen`. A single small tag has two poses that turn the view to opposite
/// sides; until the choice is certain, waiting is better than turning the wrong way.
bool is_told_apart(const ChosenPose& chosen) {
  constexpr double kSure = 0.999;
  constexpr double kOppositeRad = 0.35;
  if (!chosen.other || chosen.probability >= kSure) return true;
  return chosen.pose.T_camera_tag.rotation().angularDistance(chosen.other->T_camera_tag.rotation()) < kOppositeRad;
}

const SeenPattern* pick(const TrackingState& last, std::span<const SeenPattern> patterns, TimePoint at) {
  const bool keeps = last.id && at - last.seen_at < kKeepFor && last.seen_at - at < kKeepFor;
  for (const SeenPattern& pattern : patterns) {
    if (!keeps || pattern.wand.id() == *last.id) return &pattern;
  }
  return nullptr;
}

}  // namespace

std::optional<Wand> PatternSettings::pattern_of(int tag_id) const {
  if (flat_tag_size_m) {
    if (only && tag_id != *only) return std::nullopt;
    return flat_tag(tag_id, *flat_tag_size_m);
  }
  for (const Wand& wand : wands) {
    if (has_tag(wand, tag_id)) return wand;
  }
  const int number = tag_id / kPanels;
  if (!wands.empty() || number >= kStandardWands || tag_id < 0 || (only && number != *only)) return std::nullopt;
  return standard_wand(number);
}

TrackingResult track(const TrackingSettings& settings, const TrackingState& last,
                     std::span<const tags::TagDetection> detections, const Pinhole& lens, TimePoint captured_at) {
  const std::vector<SeenPattern> patterns = patterns_in(settings.patterns, detections);
  const SeenPattern* const pattern = pick(last, patterns, captured_at);
  if (pattern == nullptr) return {last, std::nullopt};
  const auto poses = estimate_wand_poses(pattern->wand, pattern->tags, settings.corner_floor_px, lens);
  if (!poses) return {last, std::nullopt};

  // The state of another pattern does not apply to this pattern.
  TrackingState state = last.id == pattern->wand.id() ? last : TrackingState{};
  const ChosenPose chosen = choose(settings.chooser, state.hypotheses, *poses, captured_at);
  state.id = pattern->wand.id();
  state.seen_at = captured_at;
  state.hypotheses = chosen.state;
  if (!is_told_apart(chosen)) return {state, std::nullopt};
  const T_CameraTag& pose = chosen.pose.T_camera_tag;
  state.position = filter(settings.position, state.position, pose.translation(), captured_at);
  state.rotation = filter(settings.rotation, state.rotation, pose.rotation(), captured_at);
  if (!state.position || !state.rotation) return {last, std::nullopt};
  const Matrix6d covariance =
      chosen.other ? mixed_covariance(chosen.pose, *chosen.other, chosen.probability) : chosen.pose.covariance;
  return {
      state,
      TrackedTag{
          pattern->wand, pattern->tags, *poses, chosen, covariance, {state.rotation->value, state.position->value}}};
}

}  // namespace cyclorama::tracker
