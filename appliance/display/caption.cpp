// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/caption.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/picture_place.h"

namespace cyclorama::display {

Result<Caption> caption_of(const wire::Caption& message) {
  constexpr double kMaxSize = 4.0;
  const auto wrong = [](const char* what) {
    return Error(ErrorCode::kBadData, std::string("a caption is refused: ") + what);
  };
  Caption caption;
  if (message.width_px() == 0 || message.height_px() == 0) return caption;
  if (message.width_px() > kMaxCaptionWidthPx || message.height_px() > kMaxCaptionHeightPx)
    return wrong("it has more than 4096 x 2048 pixels");
  if (message.ink().size() != std::size_t{message.width_px()} * message.height_px())
    return wrong("its size and its pixels do not agree");
  const auto is_size = [](double size) { return size > 0.0 && size <= kMaxSize; };
  if (!is_size(message.width()) || !is_size(message.height())) return wrong("its size is not above 0 and at most 4");
  const bool is_in_front =
      std::abs(message.azimuth_rad()) <= std::numbers::pi && std::abs(message.elevation_rad()) < 0.5 * std::numbers::pi;
  if (!is_in_front) return wrong("its direction is no azimuth and elevation");
  caption.ink = GreyImage(static_cast<int>(message.width_px()), static_cast<int>(message.height_px()));
  std::ranges::transform(message.ink(), caption.ink.data().begin(),
                         [](char c) { return static_cast<std::uint8_t>(c); });
  caption.azimuth_rad = message.azimuth_rad();
  caption.elevation_rad = message.elevation_rad();
  caption.width = message.width();
  caption.height = message.height();
  return caption;
}

PixelDensity pixel_density(const std::vector<HeadPlan>& heads) {
  constexpr int kStepPx = 8;
  PixelDensity all;
  for (const HeadPlan& head : heads) {
    const int x = warp::width_px(head.warp) / 2;
    const int y = warp::height_px(head.warp) / 2;
    if (x + kStepPx >= warp::width_px(head.warp)) continue;
    const auto from = direction_at(head.warp, x, y);
    const auto to = direction_at(head.warp, x + kStepPx, y);
    if (!from || !to) continue;
    const double units = std::hypot(to->azimuth_rad - from->azimuth_rad, to->tan_elevation - from->tan_elevation);
    if (!(units > 0.0)) continue;
    const double density = kStepPx / units;
    all.min = all.min > 0.0 ? std::min(all.min, density) : density;
    all.max = std::max(all.max, density);
  }
  return all;
}

Eigen::Matrix3d to_caption(const PictureShape& picture, const Caption& caption) {
  using Eigen::Vector3d;
  const double sin_azimuth = std::sin(caption.azimuth_rad);
  const double cos_azimuth = std::cos(caption.azimuth_rad);
  const double tan_elevation = std::tan(caption.elevation_rad);
  const Vector3d ahead(sin_azimuth, tan_elevation, -cos_azimuth);
  Eigen::Matrix3d matrix;
  if (std::holds_alternative<Fisheye>(picture)) {
    // On the plane that touches the unit sphere in the caption's middle.
    const Vector3d middle = ahead.normalized();
    const Vector3d right(cos_azimuth, 0.0, sin_azimuth);
    const Vector3d up = right.cross(middle);
    matrix.row(0) = right / caption.width + 0.5 * middle;
    matrix.row(1) = -up / caption.height + 0.5 * middle;
    matrix.row(2) = middle;
    return matrix * R_eye_picture(picture);
  }
  PicturePlace middle{caption.azimuth_rad, tan_elevation};
  // A caption beside a flat wall's plane is not on that wall.
  constexpr PicturePlace kNowhere{1e3, 1e3};
  if (!std::holds_alternative<Panorama>(picture)) middle = place_of(picture, ahead).value_or(kNowhere);
  matrix << 1.0 / caption.width, 0.0, 0.5 - middle.across / caption.width,  //
      0.0, -1.0 / caption.height, 0.5 + middle.up / caption.height,         //
      0.0, 0.0, 1.0;
  return matrix;
}

}  // namespace cyclorama::display
