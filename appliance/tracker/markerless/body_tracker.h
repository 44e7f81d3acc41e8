// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/tracker/markerless/background.h"
#include "appliance/tracker/markerless/body_follower.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

/// Steering without a pattern: computes the visitor's pose from grey pictures. It needs neither a trained model nor a
/// vision library: the room is known (background.h), and a person who comes to rest at a mark is followed by head and
/// chest (body_follower.h). Thread-bound; the same pictures at the same times give the same poses.
class BodyTracker {
 public:
  explicit BodyTracker(const BodySettings& body = {}, const BackgroundSettings& background = {})
      : background_(background), follower_(body) {}

  /// Returns the visitor's pose; empty while nobody is followed, in the dark, and while the light changes. Every number
  /// is finite.
  std::optional<BodyPose> update(const GreyImage& picture, const Pinhole& lens, TimePoint at);

  /// Returns the state in a few words, such as "waits for a visitor". The text has static lifetime.
  [[nodiscard]] const char* state() const;
  /// Returns the picture with marks on everything that is not the room, and on the head and chest that are followed.
  [[nodiscard]] RgbImage drawn(const GreyImage& picture) const;

 private:
  Background background_;
  BodyFollower follower_;
};

/// Returns the pose in the form of a wand's pose: the position in the Camera frame, at the camera's height, and the
/// lean as a rotation about z.
[[nodiscard]] RigidTransform<frame::Camera, frame::Tag> T_camera_body(const BodyPose& pose);

}  // namespace cyclorama::tracker
