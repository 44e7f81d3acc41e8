// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/attract_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/picture_place.h"
#include "common/image/image_file.h"
#include "common/image/jpeg.h"

namespace cyclorama::display {
namespace {

using Colour = std::array<double, 3>;
constexpr Colour kZenith{10.0, 14.0, 30.0};  // sRGB code values.
constexpr Colour kHorizon{58.0, 44.0, 40.0};
constexpr Colour kGround{14.0, 12.0, 12.0};

Colour colour_at(double tan_elevation) {
  const bool is_sky = tan_elevation >= 0.0;
  const double away = 1.0 - std::exp(-4.0 * std::abs(tan_elevation));  // 0 at the horizon.
  const Colour& end = is_sky ? kZenith : kGround;
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i) colour[i] = kHorizon[i] + (end[i] - kHorizon[i]) * away;
  return colour;
}

double tan_elevation_at(const PictureShape& shape, int x, int y) {
  const Eigen::Vector3d seen = direction_of(shape, pixel_scale(shape).place_at({x + 0.5, y + 0.5}));
  return seen.y() / std::hypot(seen.x(), seen.z());  // Infinite straight up, which gives the zenith's colour.
}

DisplayFrame frame_of(const PictureShape& shape, const RgbImage& picture) {
  DisplayFrame frame;
  frame.shape = shape;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(picture));
  return frame;
}

}  // namespace

DisplayFrame attract_frame(const PictureShape& shown) {
  RgbImage picture(width_px(shown), height_px(shown));
  const bool has_even_rows = std::holds_alternative<Panorama>(shown);
  for (int y = 0; y < picture.height(); ++y) {
    Colour colour{};
    for (int x = 0; x < picture.width(); ++x) {
      if (x == 0 || !has_even_rows) colour = colour_at(tan_elevation_at(shown, x, y));
      std::ranges::transform(colour, picture.at(x, y), [](double c) { return static_cast<std::uint8_t>(c + 0.5); });
    }
  }
  return frame_of(shown, picture);
}

Result<DisplayFrame> attract_frame(const PictureShape& shown, const std::filesystem::path& picture) {
  TRY_ASSIGN(const RgbaImage pixels, read_image(picture, kPhotoLimitPx));
  const PictureShape shape = with_pixels(shown, pixels.width(), pixels.height());
  TRY(validate(shape));
  return frame_of(shape, without_alpha(pixels));
}

}  // namespace cyclorama::display
