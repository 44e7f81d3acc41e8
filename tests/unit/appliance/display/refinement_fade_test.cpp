// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/refinement_fade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numbers>

#include "tests/support/walked_room.h"

namespace cyclorama::display {
namespace {

constexpr double kNoise = 12.0;

const Projection kPanorama{Panorama{384, 128, 2.6, 0.45, -0.45}, {}};

DisplayFrame noisy(const World& world, const Projection& picture, unsigned seed, double x_m = 0.1) {
  return frame_of(world, picture, {x_m, 0.0, 0.0}, 0.5, kNoise, seed);
}

int max_difference(const RgbImage& a, const RgbImage& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.data().size(); ++i) most = std::max(most, std::abs(a.data()[i] - b.data()[i]));
  return most;
}

TEST(RefinementFadeTest, goes_from_one_frame_to_the_other_in_steps_that_are_not_seen) {
  const World world;
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    Drawing drawing(kPanorama, texels);
    const RgbImage after = drawing.of(noisy(world, kPanorama, 2));
    const RgbImage before = drawing.of(noisy(world, kPanorama, 1));
    drawing.begin_fade(noisy(world, kPanorama, 2));
    const int whole = max_difference(before, after);
    ASSERT_GT(whole, 15);
    constexpr int kSteps = 18;
    RgbImage last = before;
    for (int step = 0; step <= kSteps; ++step) {
      const RgbImage shown = drawing.faded(static_cast<double>(step) / kSteps);
      EXPECT_LE(max_difference(shown, last), 2 + 2 * whole / kSteps) << step;
      last = shown;
    }
    EXPECT_FALSE(drawing.is_fading());
    EXPECT_EQ(last, after) << "in the end the frame is shown exactly as it came";
  }
}

TEST(RefinementFadeTest, shows_the_former_frame_at_first_whatever_its_size_and_shape) {
  const World world{false};
  const Projection round{Panorama{512, 96, 2.0 * std::numbers::pi, 0.45, -0.45}, {}};
  const Projection flat{Perspective{320, 160, -1.0, 1.0, 0.5, -0.5, 0.1}, {}};
  const Projection dome{Fisheye{240, 240, 2.6, 0.3}, {}};
  Projection both = kPanorama;
  both.viewing.eyes = Eyes::kOverUnder;
  both.viewing.eye_distance_m = 0.063;
  both.viewing.screen_distance_m = 3.0;
  for (const Projection& picture : {kPanorama, round, flat, dome, both}) {
    Projection smaller = picture;
    const auto even = [](int px) { return px * 3 / 4 / 2 * 2; };
    smaller.shape = with_pixels(picture.shape, even(width_px(picture.shape)), even(height_px(picture.shape)));
    Drawing drawing(picture);
    const RgbImage former = drawing.of(frame_of(world, smaller, {0.1, 0.0, 0.0}, 0.5));
    drawing.begin_fade(frame_of(world, picture, {0.1, 0.0, 0.0}, 0.5, kNoise, 1));
    EXPECT_GT(psnr(drawing.faded(0.0), former), 34.0) << picture.shape.index();
  }
}

TEST(RefinementFadeTest, goes_on_from_what_is_shown_if_the_next_refinement_comes_early) {
  const World world;
  Drawing drawing(kPanorama);
  drawing.of(noisy(world, kPanorama, 1));
  drawing.begin_fade(noisy(world, kPanorama, 2));
  const RgbImage half = drawing.faded(0.5);
  drawing.begin_fade(noisy(world, kPanorama, 3));
  EXPECT_LE(max_difference(drawing.faded(0.0), half), 1);
}

TEST(RefinementFadeTest, ends_when_the_eye_moves) {
  const World world;
  Drawing drawing(kPanorama);
  const DisplayFrame refined = noisy(world, kPanorama, 2);
  const Eigen::Vector3d aside(0.02, 0.0, 0.0);
  const RgbImage moved = drawing.of(refined, aside);
  drawing.of(noisy(world, kPanorama, 1));
  drawing.begin_fade(refined);
  EXPECT_EQ(drawing.after_earlier(refined, aside), moved);
  EXPECT_FALSE(drawing.is_fading());
}

}  // namespace
}  // namespace cyclorama::display
