// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/image/draw.h"

namespace cyclorama::tracker {
namespace {

constexpr Colour kFound{255, 190, 0};
constexpr Colour kFollowed{0, 255, 120};
constexpr Colour kMissing{255, 80, 60};
constexpr std::array<Colour, 3> kAxes{Colour{255, 60, 60}, Colour{60, 230, 60}, Colour{80, 140, 255}};

std::array<double, 2> point_of(const Eigen::Vector2d& pixel) { return {pixel.x(), pixel.y()}; }

void draw_outline(const tags::TagDetection& detection, Colour colour, int scale, RgbImage* ret_picture) {
  for (std::size_t i = 0; i < 4; ++i) {
    draw_line(ret_picture, point_of(detection.corners[i]), point_of(detection.corners[(i + 1) % 4]), colour, 2 * scale);
  }
  const Eigen::Vector2d& corner = detection.corners[0];
  draw_text(ret_picture, static_cast<int>(corner.x()), static_cast<int>(corner.y()) - 10 * scale,
            fmt::format("#{}", detection.id), colour, scale);
}

void draw_axes(const T_CameraTag& T_camera_tag, double length_m, const Pinhole& lens, int scale,
               RgbImage* ret_picture) {
  const auto origin = lens.pixel_of(T_camera_tag.translation());
  for (int axis = 0; axis < 3; ++axis) {
    // The z axis goes into the tag and would be hidden behind it, so it is drawn backwards, towards the camera.
    const Eigen::Vector3d tip = Eigen::Vector3d::Unit(axis) * (axis == 2 ? -length_m : length_m);
    const auto end = lens.pixel_of((T_camera_tag * Point<frame::Tag>{tip}).xyz);
    if (origin && end)
      draw_line(ret_picture, point_of(*origin), point_of(*end), kAxes[static_cast<std::size_t>(axis)], 2 * scale);
  }
}

}  // namespace

double yaw_rad(const T_CameraTag& T_camera_tag) {
  const Eigen::Vector3d into_tag = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  return std::atan2(into_tag.x(), into_tag.z());
}

RgbImage draw_overlay(const GreyImage& picture, std::span<const tags::TagDetection> detections, const TrackedTag* tag,
                      const Pinhole& lens) {
  RgbImage shown = to_rgb(picture);
  const int scale = std::clamp(picture.width() / 640, 1, 8);
  for (const tags::TagDetection& detection : detections) {
    const bool followed =
        tag != nullptr && std::any_of(tag->seen.begin(), tag->seen.end(),
                                      [&](const tags::TagDetection& s) { return s.corners == detection.corners; });
    draw_outline(detection, followed ? kFollowed : kFound, scale, &shown);
  }
  if (tag == nullptr) {
    draw_text(&shown, 8 * scale, 8 * scale, detections.empty() ? "no tag" : "another tag", kMissing, 2 * scale);
    return shown;
  }
  draw_axes(tag->T_camera_tag, 0.5 * tag->wand.tags.front().size_m, lens, scale, &shown);
  const Eigen::Vector3d& position = tag->T_camera_tag.translation();
  draw_text(&shown, 8 * scale, 8 * scale,
            fmt::format("{:.2f} m  right {:+.2f} m  yaw {:+.0f} deg", position.z(), -position.x(),
                        yaw_rad(tag->T_camera_tag) * 180.0 / std::numbers::pi),
            kFollowed, 2 * scale);
  return shown;
}

}  // namespace cyclorama::tracker
