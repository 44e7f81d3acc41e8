// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/caption/caption_place.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::tour {
namespace {

constexpr double kArcminute = kRadiansPerDegree / 60.0;

CaptionStyle style() {
  CaptionStyle style;
  style.letters_rad = 40.0 * kArcminute;
  style.width_rad = 40.0 * kRadiansPerDegree;
  return style;
}

/// 60 pixels for each degree.
CaptionWall wall(const PictureShape& shape) {
  const double density = 60.0 / kRadiansPerDegree;
  return {shape, density, density};
}

CaptionPage page() { return {GreyImage(600, 200), 0}; }

TEST(CaptionPlace, letters_appear_as_large_as_demanded_from_the_sweet_spot) {
  const CaptionWall cylinder = wall(Panorama{1000, 400, 2.6, 0.5, -0.5});
  const CaptionSize size = caption_size(style(), cylinder, 1);
  const wire::Caption caption = caption_on_wall(page(), style(), cylinder);
  // Width of a pixel on the wall, and the angle under which a letter is seen from the middle of the cylinder.
  const double letters = size.letters_px * caption.height() / 200.0;
  const double up = std::tan(caption.elevation_rad());
  const double seen = std::atan(up + 0.5 * letters) - std::atan(up - 0.5 * letters);
  EXPECT_GE(seen, 40.0 * kArcminute);
  EXPECT_LE(seen, 50.0 * kArcminute);
  EXPECT_NEAR(caption.width() / caption.height(), 3.0, 1e-9) << "pixels are square on the wall";
}

TEST(CaptionPlace, letters_are_larger_where_pixels_are_coarse) {
  CaptionWall coarse = wall(Panorama{1000, 400, 2.6, 0.5, -0.5});
  coarse.min_px_per_rad = 6.0 / kRadiansPerDegree;  // 40 minutes of arc are 4 pixels.
  const wire::Caption caption = caption_on_wall(page(), style(), coarse);
  const double letters = caption_size(style(), coarse, 1).letters_px * caption.height() / 200.0;
  EXPECT_NEAR(letters * coarse.min_px_per_rad, kMinLetterPx, 0.2);
}

TEST(CaptionPlace, is_at_the_upper_edge_of_the_wall_and_inside) {
  for (const PictureShape& shape : {PictureShape(Panorama{1000, 400, 2.6, 0.5, -0.5}),
                                    PictureShape(Perspective{1000, 600, -1.0, 1.0, 0.6, -0.6, 0.0})}) {
    const wire::Caption caption = caption_on_wall(page(), style(), wall(shape));
    const double top = std::holds_alternative<Panorama>(shape) ? 0.5 : 0.6;
    const double up = std::tan(caption.elevation_rad());
    EXPECT_LT(up + 0.5 * caption.height(), top);
    EXPECT_GT(up + 0.5 * caption.height(), top - 0.05);
    EXPECT_GT(up - 0.5 * caption.height(), 0.0) << "no shadow of a head reaches above the eyes";
    EXPECT_EQ(caption.azimuth_rad(), 0.0);
  }
}

TEST(CaptionPlace, follows_the_curator) {
  CaptionStyle low = style();
  low.elevation_rad = -0.2;
  low.azimuth_rad = 0.7;
  const wire::Caption caption = caption_on_wall(page(), low, wall(Fisheye{1000, 1000, 3.2, 0.5}));
  EXPECT_EQ(caption.elevation_rad(), -0.2);
  EXPECT_EQ(caption.azimuth_rad(), 0.7);
}

TEST(CaptionPlace, lines_fit_the_wall_however_small) {
  const CaptionWall small = wall(Panorama{100, 40, 0.3, 0.05, -0.05});
  const CaptionSize size = caption_size(style(), small, 2);
  EXPECT_GE(size.lines, 1);
  EXPECT_LE(size.width_px, 0.3 * small.max_px_per_rad);
}

}  // namespace
}  // namespace cyclorama::tour
