// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/attract_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/image/image_file.h"
#include "common/image/jpeg.h"

namespace cyclorama {
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

Frame frame_of(const Panorama& panorama, const RgbImage& picture) {
  Frame frame;
  frame.panorama = panorama;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(picture));
  return frame;
}

}  // namespace

Frame attract_frame(const Panorama& shown) {
  RgbImage picture(shown.width_px, shown.height_px);
  for (int y = 0; y < picture.height(); ++y) {
    const Colour colour = colour_at(shown.tan_elevation_at(y + 0.5));
    for (int x = 0; x < picture.width(); ++x) {
      std::ranges::transform(colour, picture.at(x, y), [](double c) { return static_cast<std::uint8_t>(c + 0.5); });
    }
  }
  return frame_of(shown, picture);
}

Result<Frame> attract_frame(const Panorama& shown, const std::filesystem::path& picture) {
  TRY_ASSIGN(const RgbaImage pixels, read_image(picture, kPhotoLimitPx));
  Panorama panorama = shown;
  panorama.width_px = pixels.width();
  panorama.height_px = pixels.height();
  TRY(panorama.validate());
  return frame_of(panorama, without_alpha(pixels));
}

}  // namespace cyclorama
