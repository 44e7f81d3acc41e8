// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/tracker/markerless/background.h"
#include "appliance/tracker/markerless/body_follower.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

/// Steering without a pattern: grey pictures in, the visitor's pose out. It needs neither a trained model nor a vision
/// library: the room is known (background.h), and a person who comes to rest at a mark is followed by head and chest
/// (body_follower.h). Thread-bound; the same pictures at the same times give the same poses.
class BodyTracker {
 public:
  explicit BodyTracker(const BodySettings& body = {}, const BackgroundSettings& background = {})
      : background_(background), follower_(body) {}

  /// Empty while nobody is followed, also in the dark and while the light changes. Every number is finite.
  std::optional<BodyPose> update(const GreyImage& picture, const Pinhole& lens, TimePoint at);

  /// Returns a few words for people, with static lifetime: "waits for a visitor".
  [[nodiscard]] const char* state() const;
  /// Draws into the picture everything that is not the room, and the head and chest that are followed.
  [[nodiscard]] RgbImage drawn(const GreyImage& picture) const;

 private:
  Background background_;
  BodyFollower follower_;
};

/// Returns the pose in the form of a wand's pose: position in the Camera frame, at the camera's height, and the lean
/// about its z.
[[nodiscard]] RigidTransform<frame::Camera, frame::Tag> T_camera_body(const BodyPose& pose);

}  // namespace cyclorama::tracker
