// SPDX-License-Identifier: Apache-2.0
// Draws moved pictures with GL, and compares them with pictures of the same world from the moved eye.
#include "appliance/display/reprojection_painter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/support/walked_room.h"

namespace cyclorama::display {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

const Projection kPanorama{Panorama{768, 256, 2.6, 0.45, -0.45}, {}};
const Projection kFlat{Perspective{640, 320, -1.0, 1.0, 0.5, -0.5, 0.1}, {}};
const Projection kDome{Fisheye{480, 480, 2.6, 0.3}, {}};

TEST(ReprojectionPainterTest, shows_a_room_from_the_moved_eye) {
  const World room{false};
  const Eigen::Vector3d eye(0.2, 0.05, -0.15);
  for (const auto& [picture, filter] :
       {std::pair(kPanorama, MeshFilter::kSharp), std::pair(kFlat, MeshFilter::kSharp),
        std::pair(kDome, MeshFilter::kSharp), std::pair(kPanorama, MeshFilter::kSharpened)}) {
    Drawing drawing(picture, Texels::kHalves, filter);
    const DisplayFrame source = frame_of(room, picture, Eigen::Vector3d::Zero());
    const RgbImage truth = drawing.of(frame_of(room, picture, eye));
    const double held = psnr(drawing.of(source), truth);
    const double moved = psnr(drawing.of(source, eye), truth);
    EXPECT_GT(moved, 38.0) << picture.shape.index();
    EXPECT_GT(moved, held + 15.0) << picture.shape.index();
  }
}

TEST(ReprojectionPainterTest, moves_a_near_pole_over_the_wall_behind_it) {
  const World world;
  const Eigen::Vector3d eye(-0.12, 0.0, 0.0);
  Drawing drawing(kPanorama);
  const DisplayFrame source = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
  const RgbImage truth = drawing.of(frame_of(world, kPanorama, eye));
  const double held = psnr(drawing.of(source), truth);
  const double moved = psnr(drawing.of(source, eye), truth);
  EXPECT_GT(drawing.torn(), 0U);
  EXPECT_GT(moved, held + 6.0);
  EXPECT_GT(moved, 25.0);
}

TEST(ReprojectionPainterTest, is_bit_identical_at_rest_whatever_was_drawn_before) {
  const World world;
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    for (const MeshFilter filter : {MeshFilter::kSharp, MeshFilter::kSharpened}) {
      Drawing drawing(kPanorama, texels, filter);
      const DisplayFrame frame = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
      const RgbImage before = drawing.of(frame);
      EXPECT_NE(drawing.of(frame, {0.1, 0.0, 0.0}), before);
      EXPECT_EQ(drawing.unmoved(frame), before);
    }
  }
}

constexpr double kWall_m = 3.0;

/// A wall with upright stripes around code 127.
DisplayFrame striped_frame(double period_px, double amplitude_codes) {
  RgbImage pixels(kFlat.width_px(), kFlat.height_px());
  for (int y = 0; y < pixels.height(); ++y) {
    for (int x = 0; x < pixels.width(); ++x) {
      const double code = 127.0 + amplitude_codes * std::sin(kTurn * x / period_px);
      std::fill_n(pixels.at(x, y), 3, static_cast<std::uint8_t>(std::clamp(std::lround(code), 0L, 255L)));
    }
  }
  const PixelRect cells = depth_cells({0, 0, pixels.width(), pixels.height()});
  DisplayFrame frame;
  frame.shape = kFlat.shape;
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(pixels));
  frame.mesh = std::make_shared<const ReprojectionMesh>(
      std::make_shared<const ReprojectionGrid>(kFlat, kDepthCellPx),
      InverseDepthImage(cells.width, cells.height, inverse_depth_of(static_cast<float>(kWall_m))));
  return frame;
}

double middle_amplitude(const RgbImage& picture) {
  constexpr int kReach = 24;
  const int middle_x = picture.width() / 2;
  const int middle_y = picture.height() / 2;
  double squares = 0.0;
  for (int x = -kReach; x < kReach; ++x) {
    const double off = picture.at(middle_x + x, middle_y)[1] - 127.0;
    squares += off * off;
  }
  return std::sqrt(squares / kReach);
}

/// The move that shifts the wall's middle.
Eigen::Vector3d move_by_px(double px) { return {px * kWall_m * 2.0 / kFlat.width_px(), 0.0, 0.0}; }

TEST(ReprojectionPainterTest, keeps_fine_stripes_between_two_pixels) {
  const DisplayFrame frame = striped_frame(6.0, 60.0);
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    // A bilinear filter alone keeps .87 of them.
    Drawing sharp(kFlat, texels, MeshFilter::kSharp);
    EXPECT_GT(middle_amplitude(sharp.of(frame, move_by_px(0.5))), 0.95 * 60.0);
    EXPECT_NEAR(middle_amplitude(sharp.of(frame, move_by_px(0.01))), 60.0, 2.0);
  }
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    Drawing sharpened(kFlat, texels, MeshFilter::kSharpened);
    EXPECT_GT(middle_amplitude(sharpened.of(frame, move_by_px(0.5))), 0.92 * 60.0);
    EXPECT_LT(middle_amplitude(sharpened.of(frame, move_by_px(0.01))), 1.1 * 60.0);
  }
}

TEST(ReprojectionPainterTest, stays_within_black_and_white_where_filters_overshoot) {
  const DisplayFrame frame = striped_frame(8.0, 1000.0);
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    for (const MeshFilter filter : {MeshFilter::kSharp, MeshFilter::kSharpened}) {
      Drawing drawing(kFlat, texels, filter);
      const RgbImage shown = drawing.of(frame, move_by_px(0.3));
      for (int x = 0; x < shown.width(); ++x) {
        const std::uint8_t* const pixel = shown.at(x, shown.height() / 2);
        EXPECT_NEAR(pixel[0], pixel[1], 3) << x;
        EXPECT_NEAR(pixel[2], pixel[1], 3) << x;
      }
    }
  }
}

TEST(ReprojectionPainterTest, sharpens_each_frame_anew) {
  const DisplayFrame stripes = striped_frame(6.0, 60.0);
  const DisplayFrame grey = striped_frame(6.0, 0.0);
  Drawing drawing(kFlat, Texels::kHalves, MeshFilter::kSharpened);
  drawing.of(stripes, move_by_px(0.5));
  EXPECT_LT(middle_amplitude(drawing.of(grey, move_by_px(0.5))), 2.0);
}

TEST(ReprojectionPainterTest, agrees_between_both_formats_of_light) {
  const World world;
  const Eigen::Vector3d eye(0.1, -0.1, 0.1);
  const DisplayFrame frame = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
  const RgbImage packed = Drawing(kPanorama, Texels::kPacked).of(frame, eye);
  const RgbImage halves = Drawing(kPanorama).of(frame, eye);
  EXPECT_GT(psnr(packed, halves), 45.0);
}

TEST(ReprojectionPainterTest, has_no_seam_in_a_whole_turn) {
  const Projection round{Panorama{1024, 256, kTurn, 0.45, -0.45}, {}};
  const World room{false};
  const Eigen::Vector3d eye(0.25, 0.0, 0.2);
  const DisplayFrame source = frame_of(room, round, Eigen::Vector3d::Zero());
  // The head looks at the middle of the picture; half a turn brings the seam there.
  constexpr double kBack = std::numbers::pi;
  for (const MeshFilter filter : {MeshFilter::kSharp, MeshFilter::kSharpened}) {
    Drawing drawing(round, Texels::kHalves, filter);
    const RgbImage truth = drawing.of(frame_of(room, round, eye), Eigen::Vector3d::Zero(), kBack);
    EXPECT_GT(psnr(drawing.of(source, eye, kBack), truth), 38.0);
  }
}

TEST(ReprojectionPainterTest, draws_frames_of_other_sizes_one_after_another) {
  const World room{false};
  const Eigen::Vector3d eye(0.1, 0.0, 0.1);
  const DisplayFrame large = frame_of(room, kPanorama, Eigen::Vector3d::Zero());
  const DisplayFrame small = frame_of(room, {Panorama{384, 128, 2.6, 0.45, -0.45}, {}}, Eigen::Vector3d::Zero());
  const RgbImage large_alone = Drawing(kPanorama).of(large, eye);  // One context at a time.
  const RgbImage small_alone = Drawing(kPanorama).of(small, eye);
  Drawing drawing(kPanorama);
  for (int n = 0; n < 2; ++n) {
    EXPECT_GT(psnr(drawing.of(small, eye), small_alone), 55.0) << n;
    EXPECT_GT(psnr(drawing.of(large, eye), large_alone), 55.0) << n;
  }
}

}  // namespace
}  // namespace cyclorama::display
