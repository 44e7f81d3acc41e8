// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/markerless/body_tracker.h"

#include <algorithm>
#include <array>

#include "common/image/draw.h"

namespace cyclorama::tracker {

std::optional<BodyPose> BodyTracker::update(const GreyImage& picture, const Pinhole& lens, TimePoint at) {
  if (picture.empty()) return std::nullopt;
  const Silhouette& silhouette = background_.update(picture, at, follower_.region());
  if (silhouette.share.empty()) return std::nullopt;
  const double side = background_.cell_px(picture.width());
  Pinhole cells = lens;
  cells.width_px = silhouette.share.width();
  cells.height_px = silhouette.share.height();
  cells.focal_px /= side;
  cells.centre_u_px /= side;
  cells.centre_v_px /= side;
  return follower_.update(silhouette, cells, at);
}

const char* BodyTracker::state() const {
  switch (background_.silhouette().light) {
    case LightState::kLearning:
      return "learns how the empty room looks";
    case LightState::kUnsettled:
      return "waits for the light to settle";
    case LightState::kDark:
      return "sees too little light";
    case LightState::kSteady:
      break;
  }
  switch (follower_.phase()) {
    case BodyPhase::kNobody:
      return "waits for a visitor at the mark";
    case BodyPhase::kArriving:
      return "sees a visitor arrive";
    case BodyPhase::kFollowed:
      break;
  }
  return "follows a visitor";
}

RgbImage BodyTracker::drawn(const GreyImage& picture) const {
  RgbImage shown = to_rgb(picture);
  const Silhouette& silhouette = background_.silhouette();
  if (silhouette.share.empty()) return shown;
  const int side = background_.cell_px(picture.width());
  for (int y = 0; y < silhouette.share.height() * side; ++y) {
    for (int x = 0; x < silhouette.share.width() * side; ++x) {
      if (*silhouette.share.at(x / side, y / side) < 0.5f) continue;
      std::uint8_t* const pixel = shown.at(x, y);
      pixel[0] = static_cast<std::uint8_t>(pixel[0] / 2 + 100);
    }
  }
  if (!follower_.shape()) return shown;
  const BodyShape& shape = *follower_.shape();
  const Colour colour = follower_.phase() == BodyPhase::kFollowed ? Colour{0, 255, 120} : Colour{255, 190, 0};
  const double left = (shape.head.u - 0.5 * shape.head.width) * side, right = left + shape.head.width * side;
  const double top = shape.head.top * side, bottom = top + 1.4 * shape.head.width * side;
  const std::array<std::array<double, 2>, 4> corners{{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
  for (std::size_t i = 0; i < 4; ++i) draw_line(&shown, corners[i], corners[(i + 1) % 4], colour, 2);
  const std::array<double, 2> chin{0.5 * (left + right), bottom};
  draw_line(&shown, chin, {shape.hip_u * side, top + 5.2 * shape.head.width * side}, colour, 2);
  return shown;
}

RigidTransform<frame::Camera, frame::Tag> T_camera_body(const BodyPose& pose) {
  // The visitor's right is the camera's -x. The camera's y points down, so it sees a lean to the visitor's right as an
  // anticlockwise turn.
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(-pose.lean_rad, Eigen::Vector3d::UnitZ()));
  return {lean, {pose.x_m, 0.0, pose.depth_m}};
}

}  // namespace cyclorama::tracker
