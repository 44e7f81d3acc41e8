// SPDX-License-Identifier: Apache-2.0
// Draws moved pictures with GL, and compares them with pictures of the same world from the moved eye.
#include "appliance/display/reprojection_painter.h"

#include <gtest/gtest.h>

#include <numbers>

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
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    Drawing drawing(picture);
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
    Drawing drawing(kPanorama, texels);
    const DisplayFrame frame = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
    const RgbImage before = drawing.of(frame);
    EXPECT_NE(drawing.of(frame, {0.1, 0.0, 0.0}), before);
    EXPECT_EQ(drawing.unmoved(frame), before);
  }
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
  Drawing drawing(round);
  // The head looks at the middle of the picture; half a turn brings the seam there.
  constexpr double kBack = std::numbers::pi;
  const RgbImage truth = drawing.of(frame_of(room, round, eye), Eigen::Vector3d::Zero(), kBack);
  EXPECT_GT(psnr(drawing.of(source, eye, kBack), truth), 38.0);
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
