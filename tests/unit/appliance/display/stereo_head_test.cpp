// SPDX-License-Identifier: Apache-2.0
// Compares the graphics card's drawing for two eyes with the same in double precision on the CPU.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/image/cropped.h"
#include "tests/data_sets/demo_room.h"
#include "tests/support/painted_head.h"

namespace cyclorama::display {
namespace {

using Renderer = output::HeadlessOptions::Renderer;

constexpr double kSlack_px = 0.02;
constexpr double kSlackLight = 1.0 / 2048.0;  // Precision of half floats.
constexpr StereoPacking kPackings[] = {StereoPacking::kSideBySide, StereoPacking::kTopBottom,
                                       StereoPacking::kFrameSequential};
constexpr Eye kEyes[] = {Eye::kLeft, Eye::kRight};

/// Returns one of the two pictures.
PlanarPicture of_eye(const PlanarPicture& both, Eye eye) {
  const int height = both.height() / 2;
  PlanarPicture one(both.width(), height, both.has_half_chroma());
  const auto copy = [&](const GreyImage& from, GreyImage* to) {
    const int first = eye == Eye::kRight ? from.height() / 2 : 0;
    *to = cropped(from, {0, first, to->width(), to->height()});
  };
  copy(both.luma(), &one.luma());
  copy(both.blue(), &one.blue());
  copy(both.red(), &one.red());
  return one;
}

/// Returns the part of a head for one eye.
RgbImage part_of(const RgbImage& head, StereoPacking packing, Eye eye) {
  const HeadPart part = part_of_eye(packing, eye, head.width(), head.height());
  return cropped(head, {part.x_px, part.y_px, part.width_px, part.height_px});
}

class StereoHeadTest : public ::testing::TestWithParam<Renderer> {
 protected:
  RgbImage seen_by(Eye eye, const HeadPlan& plan, const PlanarPicture& picture, const PictureShape& shape,
                   double turn = 0.0) {
    return part_of(head_.drawn_for_two(plan, picture, shape, turn, eye), *plan.packing, eye);
  }
  PaintedHead head_{GetParam()};
};

TEST_P(StereoHeadTest, agrees_with_the_cpu_for_each_eye_over_random_warps_masks_and_colours) {
  RandomHeads heads(21);
  double worst = 0.0;
  for (int n = 0; n < 24; ++n) {
    const int width = heads.pixels(16, 120);
    const int height = heads.pixels(16, 90);
    const int side = 16 * heads.pixels(1, 6);
    const PictureShape shape =
        n % 3 == 0 ? heads.other_shape(heads.pixels(16, 200), side)
                   : PictureShape(Panorama{heads.pixels(16, 200), side,
                                           n % 4 == 0 ? 2.0 * std::numbers::pi : heads.between(0.5, 6.0), 0.5, -0.5});
    const auto* const panorama = std::get_if<Panorama>(&shape);
    const bool mapped = n % 2 == 0;
    const double span = panorama != nullptr ? panorama->azimuth_span_rad : 1.2;
    HeadPlan plan{
        mapped ? warp::Warp(heads.map(width, height, span)) : warp::Warp(heads.mesh(width, height, span, n % 5 == 0)),
        heads.mask(width, height), n < 6 ? warp::HeadColour{} : heads.colour(width, height), 8, false};
    plan.picture = shape;
    plan.packing = kPackings[n % 3 == 0 ? n / 3 % 3 : n % 3];
    const PlanarPicture both = heads.noise(width_px(shape), 2 * height_px(shape), heads.one_in(2));
    const double turn = heads.between(-0.3, 0.3);
    for (const Eye eye : kEyes) {
      const ExactPicture reference(of_eye(both, eye), shape, turn);
      const RgbImage seen = seen_by(eye, plan, both, shape, turn);
      ASSERT_EQ(seen.width(), width);
      ASSERT_EQ(seen.height(), height);
      worst = std::max(worst, worst_difference(seen, plan, reference, kSlack_px, kSlackLight));
      ASSERT_LE(worst, 1.0) << "case " << n;
    }
  }
  std::printf("noise for two eyes within 0.02 px: worst %.3f code values\n", worst);
}

TEST_P(StereoHeadTest, agrees_with_the_cpu_pixel_for_pixel_on_the_demo) {
  Installation room = *read_installation(demo_installation_path().parent_path() / "stereo.toml");
  for (const StereoPacking packing : kPackings) {
    Installation seen = room;
    for (InstalledProjector& projector : seen.projectors) {
      projector.lens = lens_of_eye(projector.lens.with_pixels(320, 240), packing);
    }
    const PictureShape shape = room.projection(512).shape;
    RgbImage smooth(width_px(shape), 2 * height_px(shape));
    for (int y = 0; y < smooth.height(); ++y) {
      for (int x = 0; x < smooth.width(); ++x) {
        smooth.at(x, y)[0] = static_cast<std::uint8_t>(127.5 + 127.0 * std::sin(x * 0.05));
        smooth.at(x, y)[1] = static_cast<std::uint8_t>(127.5 + 127.0 * std::sin(y * 0.07));
        smooth.at(x, y)[2] = y < height_px(shape) ? 255 : 0;
      }
    }
    const PlanarPicture both = JpegEncoder().to_planar(smooth);
    const std::vector<warp::ProjectorMap> maps = warp::projector_maps(seen);
    const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
    double worst = 0.0;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto warp = warp::make_warp(maps[i], shape);
      ASSERT_TRUE(warp) << warp.error().message();
      HeadPlan plan{*warp, masks[i], {}, 8, false};
      plan.packing = packing;
      for (const Eye eye : kEyes) {
        const ExactPicture reference(of_eye(both, eye), shape, 0.0);
        worst = std::max(worst, worst_difference(seen_by(eye, plan, both, shape), plan, reference, 0.0));
      }
    }
    std::printf("packing %d: worst %.3f code values\n", static_cast<int>(packing), worst);
    EXPECT_LE(worst, 1.0);
  }
}

/// Saturated, so that half chroma would show; its upper half has one colour, its lower another.
PlanarPicture red_above_blue(int width, int height, bool half_chroma) {
  PlanarPicture both(width, height, half_chroma);
  const auto fill = [](GreyImage* plane, std::uint8_t upper, std::uint8_t lower) {
    const auto values = plane->data();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::fill(values.begin(), middle, upper);
    std::fill(middle, values.end(), lower);
  };
  fill(&both.luma(), 76, 29);
  fill(&both.blue(), 85, 255);
  fill(&both.red(), 255, 107);
  return both;
}

TEST_P(StereoHeadTest, never_mixes_the_eyes_pictures) {
  RandomHeads heads(8);
  const Panorama shape{48, 32, 1.0, 0.25, -0.25};
  for (const StereoPacking packing : kPackings) {
    for (const bool half_chroma : {false, true}) {
      const PlanarPicture both = red_above_blue(48, 64, half_chroma);
      for (const bool mapped : {false, true}) {
        // It extends far past the picture's upper and lower edges.
        HeadPlan plan{mapped ? warp::Warp(heads.map(40, 30, 1.0)) : warp::Warp(heads.mesh(40, 30, 1.0)),
                      warp::MaskImage(40, 30, 1.0f),
                      {},
                      8,
                      false};
        plan.packing = packing;
        const RgbImage left = seen_by(Eye::kLeft, plan, both, shape);
        const RgbImage right = seen_by(Eye::kRight, plan, both, shape);
        for (int y = 0; y < 30; ++y) {
          for (int x = 0; x < 40; ++x) {
            if (!direction_at(plan.warp, x, y) || is_on_the_rim(plan.warp, x, y)) continue;
            ASSERT_GE(left.at(x, y)[0], 250) << x << ", " << y;
            ASSERT_LE(left.at(x, y)[2], 3) << x << ", " << y;
            ASSERT_LE(right.at(x, y)[0], 3) << x << ", " << y;
            ASSERT_GE(right.at(x, y)[2], 250) << x << ", " << y;
          }
        }
      }
    }
  }
}

/// Allows a code value of difference, since the same triangles lie elsewhere.
void expect_same(const HeadPlan& plan, const RgbImage& a, const RgbImage& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (is_on_the_rim(plan.warp, x, y)) continue;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.at(x, y)[c], b.at(x, y)[c], 1) << x << ", " << y;
    }
  }
}

TEST_P(StereoHeadTest, shows_one_picture_to_both_eyes_and_the_left_one_on_a_mono_head) {
  RandomHeads heads(9);
  const Panorama shape{64, 32, 1.0, 0.5, -0.5};
  const PlanarPicture one = heads.noise(64, 32, true);
  HeadPlan plan{heads.mesh(50, 40, 1.0), heads.mask(50, 40), {}, 8, false};
  const RgbImage expected = head_.drawn(plan, one, shape, 0.1);
  for (const StereoPacking packing : kPackings) {
    plan.packing = packing;
    for (const Eye eye : kEyes) expect_same(plan, seen_by(eye, plan, one, shape, 0.1), expected);
  }
  plan.packing.reset();
  const PlanarPicture both = heads.noise(64, 64, true);
  const RgbImage left = head_.drawn(plan, of_eye(both, Eye::kLeft), shape, 0.1);
  for (const Eye now : kEyes) expect_same(plan, head_.drawn_for_two(plan, both, shape, 0.1, now), left);
}

INSTANTIATE_TEST_SUITE_P(Headless, StereoHeadTest, ::testing::Values(Renderer::kEgl, Renderer::kOsMesa),
                         [](const auto& tested) { return tested.param == Renderer::kEgl ? "egl" : "osmesa"; });

}  // namespace
}  // namespace cyclorama::display
