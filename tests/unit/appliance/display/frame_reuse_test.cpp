// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/frame_reuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "appliance/display/eye_move.h"
#include "tests/support/walked_room.h"

namespace cyclorama::display {
namespace {

constexpr double kNoise = 12.0;
constexpr int kFrames = 12;

const Projection kPanorama{Panorama{384, 128, 2.6, 0.45, -0.45}, {}};

Projection for_two_eyes() {
  Projection both{Panorama{384, 128, 2.6, 0.45, -0.45}, {}};
  both.viewing.eyes = Eyes::kOverUnder;
  both.viewing.eye_distance_m = 0.063;
  both.viewing.screen_distance_m = 3.0;
  return both;
}

struct Walked {
  double alone_db = 0.0;    ///< The last frame as it came, against the same without noise.
  double reusing_db = 0.0;  ///< With the frames before it.
};

/// Walks and turns through noisy frames of a room.
Walked walked(const World& world, const Projection& picture, double turn_rad, Texels texels = Texels::kHalves) {
  Drawing drawing(picture, texels);
  RgbImage shown;
  DisplayFrame last;
  for (int n = 0; n < kFrames; ++n) {
    last = frame_of(world, picture, {0.02 * n, 0.0, -0.03 * n}, turn_rad * n, kNoise, static_cast<unsigned>(n));
    shown = drawing.after_earlier(last);
  }
  const RgbImage truth = drawing.of(frame_of(world, picture, last.eye_m, last.heading_rad));
  return {psnr(drawing.of(last), truth), psnr(shown, truth)};
}

TEST(FrameReuseTest, averages_the_noise_of_frames_that_show_the_same_surfaces) {
  const World room{false};
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    const Walked walk = walked(room, kPanorama, 0.0, texels);
    EXPECT_GT(walk.reusing_db, walk.alone_db + 5.0) << walk.alone_db;
  }
}

TEST(FrameReuseTest, serves_every_shape_of_picture_and_two_eyes_while_the_visitor_turns) {
  const World room{false};
  const Projection round{Panorama{512, 96, 2.0 * std::numbers::pi, 0.45, -0.45}, {}};
  const Projection flat{Perspective{320, 160, -1.0, 1.0, 0.5, -0.5, 0.1}, {}};
  const Projection dome{Fisheye{240, 240, 2.6, 0.3}, {}};
  for (const Projection& picture : {kPanorama, round, flat, dome, for_two_eyes()}) {
    for (const double turn_rad : {0.0, 0.04, -0.04}) {
      const Walked walk = walked(room, picture, turn_rad);
      EXPECT_GT(walk.reusing_db, walk.alone_db + 4.0)
          << picture.shape.index() << ' ' << turn_rad << ' ' << walk.alone_db;
    }
  }
}

TEST(FrameReuseTest, changes_little_from_one_frame_to_the_next) {
  const World room{false};
  Drawing drawing(kPanorama);
  const Eigen::Vector3d step_m(0.02, 0.0, 0.0);
  const auto frame_at = [&](int n) {
    return frame_of(room, kPanorama, n * step_m, 0.0, kNoise, static_cast<unsigned>(n));
  };
  // The last two frames, both seen from the eye of the last.
  RgbImage by_old;
  RgbImage by_new;
  for (int n = 0; n < kFrames; ++n) {
    by_old = n == kFrames - 1 ? by_old : drawing.after_earlier(frame_at(n), step_m);
    by_new = n == kFrames - 1 ? drawing.after_earlier(frame_at(n)) : by_new;
  }
  const double as_they_come_db = psnr(drawing.of(frame_at(kFrames - 2), step_m), drawing.of(frame_at(kFrames - 1)));
  EXPECT_GT(psnr(by_old, by_new), as_they_come_db + 9.0);
}

TEST(FrameReuseTest, shows_a_first_frame_and_one_that_refines_it_exactly_as_they_came) {
  const World world;
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    Drawing drawing(kPanorama, texels);
    const DisplayFrame noisy = frame_of(world, kPanorama, {0.1, 0.0, 0.0}, 0.5, kNoise, 1);
    const DisplayFrame refined = frame_of(world, kPanorama, {0.1, 0.0, 0.0}, 0.5, 1.0, 2);
    const RgbImage alone = drawing.of(refined);
    const RgbImage first = drawing.of(noisy);
    EXPECT_EQ(drawing.after_earlier(refined), alone);
    EXPECT_NE(first, alone);
  }
}

TEST(FrameReuseTest, reuses_nothing_across_a_leap_or_without_depth) {
  const World world;
  Drawing drawing(kPanorama);
  const DisplayFrame there = frame_of(world, kPanorama, {0.0, 0.0, kMaxMove_m}, 0.0, kNoise, 2);
  const RgbImage alone = drawing.of(there);
  drawing.of(frame_of(world, kPanorama, {0.0, 0.0, 0.0}, 0.0, kNoise, 1));
  EXPECT_EQ(drawing.after_earlier(there), alone);

  const DisplayFrame near = frame_of(world, kPanorama, {0.0, 0.0, 0.05}, 0.0, kNoise, 3);
  DisplayFrame without_depth = near;
  without_depth.mesh.reset();
  const RgbImage near_alone = drawing.of(near);
  drawing.of(frame_of(world, kPanorama, {0.0, 0.0, 0.0}, 0.0, kNoise, 1));
  EXPECT_EQ(drawing.after_earlier(without_depth), near_alone);
  EXPECT_EQ(drawing.after_earlier(near), near_alone) << "after one without depth";
}

/// A frame of one colour at one distance.
DisplayFrame plain_frame(const Projection& picture, std::uint8_t code, float distance_m, double x_m) {
  RgbImage pixels(picture.width_px(), picture.height_px());
  std::ranges::fill(pixels.data(), code);
  const PixelRect cells = depth_cells({0, 0, pixels.width(), pixels.height()});
  DisplayFrame frame;
  frame.eye_m = {x_m, 0.0, 0.0};
  frame.shape = picture.shape;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(pixels));
  frame.mesh = std::make_shared<const ReprojectionMesh>(
      std::make_shared<const ReprojectionGrid>(picture, kDepthCellPx),
      InverseDepthImage(cells.width, cells.height, inverse_depth_of(distance_m)));
  return frame;
}

int code_in_the_middle(const RgbImage& picture) { return picture.at(picture.width() / 2, picture.height() / 2)[1]; }

TEST(FrameReuseTest, takes_nothing_from_another_surface) {
  Drawing drawing(kPanorama);
  drawing.of(plain_frame(kPanorama, 103, 3.0f, 0.0));
  EXPECT_EQ(code_in_the_middle(drawing.after_earlier(plain_frame(kPanorama, 100, 2.0f, 0.02))), 100);
  drawing.of(plain_frame(kPanorama, 103, 3.0f, 0.0));
  EXPECT_GT(code_in_the_middle(drawing.after_earlier(plain_frame(kPanorama, 100, 3.0f, 0.02))), 100);
}

TEST(FrameReuseTest, shows_no_colour_that_a_new_frame_has_not_even_where_depth_lies) {
  Drawing drawing(kPanorama);
  drawing.of(plain_frame(kPanorama, 250, 3.0f, 0.0));
  const int code = code_in_the_middle(drawing.after_earlier(plain_frame(kPanorama, 60, 3.0f, 0.02)));
  EXPECT_GE(code, 60);
  EXPECT_LE(code, 65);
}

TEST(FrameReuseTest, keeps_black_and_white_in_both_formats_of_light) {
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    for (const int code : {0, 1, 254, 255}) {
      Drawing drawing(kPanorama, texels);
      const auto of_code = static_cast<std::uint8_t>(code);
      RgbImage edge;
      for (int n = 0; n < 4; ++n) {
        DisplayFrame frame = plain_frame(kPanorama, of_code, 3.0f, 0.02 * n);
        // A line beside which the sharp filter overshoots.
        auto picture = std::make_shared<PlanarPicture>(*frame.picture);
        for (int y = 0; y < picture->height(); ++y) *picture->luma().at(picture->width() / 2 + 3, y) = 128;
        frame.picture = picture;
        edge = drawing.after_earlier(frame);
      }
      const std::uint8_t* const beside = edge.at(edge.width() / 2 - 8, edge.height() / 2);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(beside[c], code, 1) << c;
      for (int x = 0; x < edge.width(); ++x) {
        const std::uint8_t* const pixel = edge.at(x, edge.height() / 2);
        EXPECT_NEAR(pixel[0], pixel[1], 2) << x << ' ' << code;
        EXPECT_NEAR(pixel[2], pixel[1], 2) << x << ' ' << code;
      }
    }
  }
}

TEST(FrameReuseTest, follows_frames_of_other_sizes) {
  const World room{false};
  const Projection small{Panorama{192, 64, 2.6, 0.45, -0.45}, {}};
  Drawing drawing(kPanorama);
  RgbImage shown;
  DisplayFrame last;
  for (int n = 0; n < kFrames; ++n) {
    last = frame_of(room, n % 3 == 1 ? small : kPanorama, {0.02 * n, 0.0, 0.0}, 0.0, kNoise, static_cast<unsigned>(n));
    shown = drawing.after_earlier(last);
  }
  const RgbImage truth = drawing.of(frame_of(room, kPanorama, last.eye_m));
  EXPECT_GT(psnr(shown, truth), psnr(drawing.of(last), truth) + 3.0);
}

}  // namespace
}  // namespace cyclorama::display
