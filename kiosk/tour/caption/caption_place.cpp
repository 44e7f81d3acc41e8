// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_place.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/picture_place.h"

namespace cyclorama::tour {
namespace {

constexpr double kDomeElevationRad = 0.35;  ///< Above the springline, where nobody lays the head back.
constexpr double kMaxShareOfWidth = 0.9;
constexpr double kMaxShareOfHeight = 0.6;
constexpr double kLinePerLetter = 1.65;  ///< Distance of two lines in relation to a capital letter's height.
constexpr int kMaxLines = 6;
constexpr double kMaxLarger = 4.0;  ///< At most as much larger than demanded, however coarse pixels are.

/// The wall's extent in the units of wire::Caption; empty for a dome.
struct Extent {
  double width = 0.0;
  double top = 0.0;
  double height = 0.0;
};
std::optional<Extent> extent_of(const PictureShape& shape) {
  if (const auto* const panorama = std::get_if<Panorama>(&shape))
    return Extent{panorama->azimuth_span_rad, panorama->tan_elevation_top,
                  panorama->tan_elevation_top - panorama->tan_elevation_bottom};
  if (const auto* const flat = std::get_if<Perspective>(&shape))
    return Extent{flat->tan_right - flat->tan_left, flat->tan_top, flat->tan_top - flat->tan_bottom};
  return std::nullopt;
}

/// Returns how much larger letters are drawn than they appear: the wall is farther away above the horizon, and slanted.
double enlarged(const CaptionStyle& style, const CaptionWall& wall) {
  const auto extent = extent_of(wall.shape);
  if (!extent) return 1.0;
  const double tan_up = style.elevation_rad ? std::tan(*style.elevation_rad) : extent->top;
  return 1.0 + tan_up * tan_up;
}

/// Capital letters' height in the units of wire::Caption.
double letters_on_wall(const CaptionStyle& style, const CaptionWall& wall) {
  const double demanded = style.letters_rad * enlarged(style, wall);
  return std::clamp(kMinLetterPx / wall.min_px_per_rad, demanded, kMaxLarger * demanded);
}

double px_per_unit(const CaptionStyle& style, const CaptionWall& wall) {
  // Pictures have limits, whatever the projectors' pixels.
  constexpr double kMaxLettersPx = 200.0;
  return std::min(wall.max_px_per_rad, kMaxLettersPx / letters_on_wall(style, wall));
}

}  // namespace

CaptionSize caption_size(const CaptionStyle& style, const CaptionWall& wall, std::size_t languages) {
  const double per_unit = px_per_unit(style, wall);
  const double letters = letters_on_wall(style, wall);
  const auto extent = extent_of(wall.shape);
  double width = std::max(style.width_rad * letters / style.letters_rad, 10.0 * letters);
  double lines = kMaxLines;
  if (extent) {
    width = std::min(width, kMaxShareOfWidth * extent->width);
    lines = kMaxShareOfHeight * extent->height / (kLinePerLetter * letters) - 1.0;
  }
  CaptionSize size;
  size.letters_px = std::max(4, static_cast<int>(std::lround(letters * per_unit)));
  size.width_px =
      std::clamp(static_cast<int>(width * per_unit), 10 * size.letters_px, kMaxCaptionWidthPx - 4 * size.letters_px);
  size.lines =
      std::clamp(static_cast<int>(lines / static_cast<double>(std::max<std::size_t>(languages, 1))), 1, kMaxLines);
  return size;
}

wire::Caption caption_on_wall(const CaptionPage& page, const CaptionStyle& style, const CaptionWall& wall) {
  const double per_unit = px_per_unit(style, wall);
  wire::Caption caption;
  caption.set_width_px(static_cast<std::uint32_t>(page.ink.width()));
  caption.set_height_px(static_cast<std::uint32_t>(page.ink.height()));
  caption.set_ink(page.ink.data().data(), page.ink.data().size());
  caption.set_width(page.ink.width() / per_unit);
  caption.set_height(page.ink.height() / per_unit);
  caption.set_azimuth_rad(style.azimuth_rad);
  const auto extent = extent_of(wall.shape);
  if (style.elevation_rad || !extent) {
    caption.set_elevation_rad(style.elevation_rad.value_or(kDomeElevationRad));
    return caption;
  }
  const double margin = letters_on_wall(style, wall);
  const double up = extent->top - margin - 0.5 * caption.height();
  const auto* const flat = std::get_if<Perspective>(&wall.shape);
  const double across = flat == nullptr ? style.azimuth_rad : std::tan(style.azimuth_rad);
  const Eigen::Vector3d middle = direction_of(wall.shape, {across, up});
  caption.set_elevation_rad(std::atan2(middle.y(), std::hypot(middle.x(), middle.z())));
  if (flat != nullptr) caption.set_azimuth_rad(std::atan2(middle.x(), -middle.z()));
  return caption;
}

}  // namespace cyclorama::tour
