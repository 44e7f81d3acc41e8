// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tag_tracking.h"

namespace cyclorama {
namespace {

const TagDetection* pick(const TrackingSettings& settings, const TrackingState& last,
                         std::span<const TagDetection> detections, TimePoint at) {
  const bool keeps = last.id && at - last.seen_at < kKeepFor && last.seen_at - at < kKeepFor;
  const std::optional<int> wanted = settings.only_id ? settings.only_id : keeps ? last.id : std::nullopt;
  for (const TagDetection& detection : detections) {  // The largest comes first.
    if (!wanted || detection.id == *wanted) return &detection;
  }
  return nullptr;
}

}  // namespace

TrackingResult track(const TrackingSettings& settings, const TrackingState& last,
                     std::span<const TagDetection> detections, const Pinhole& lens, TimePoint captured_at) {
  const TagDetection* const detection = pick(settings, last, detections, captured_at);
  if (detection == nullptr) return {last, std::nullopt};
  const std::optional<TagPoses> poses = estimate_poses(detection->corners, settings.tag_size_m, lens);
  if (!poses) return {last, std::nullopt};

  // Another tag's past says nothing about this one.
  TrackingState state = last.id == detection->id ? last : TrackingState{};
  const ChosenPose chosen = choose(settings.chooser, state.hypotheses, *poses, captured_at);
  const T_CameraTag& pose = chosen.pose.T_camera_tag;
  state.id = detection->id;
  state.seen_at = captured_at;
  state.hypotheses = chosen.state;
  state.position = filter(settings.position, state.position, pose.translation(), captured_at);
  state.rotation = filter(settings.rotation, state.rotation, pose.rotation(), captured_at);
  if (!state.position || !state.rotation) return {last, std::nullopt};
  return {state, TrackedTag{*detection, *poses, chosen, {state.rotation->value, state.position->value}}};
}

}  // namespace cyclorama
