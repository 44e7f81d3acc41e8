// SPDX-License-Identifier: Apache-2.0
#include "appliance/tags/corner_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "appliance/tracker/tag_pose.h"
#include "tests/data_sets/painted_tag.h"

namespace cyclorama::tags {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;
constexpr int kCells = 8;
const Pinhole kLens = Pinhole::from_field_of_view(640, 480, 1.0472);
const tracker::T_CameraTag kPose(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized())),
                                 {0.05, 0.02, 0.9});

Corners true_corners() {
  Corners corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners[i] = *kLens.pixel_of((kPose * Point<frame::Tag>{tracker::corners_of_tag(0.12)[i]}).xyz);
  }
  return corners;
}

double farthest(const Corners& a, const Corners& b) {
  double max = 0.0;
  for (std::size_t i = 0; i < 4; ++i) max = std::max(max, (a[i] - b[i]).norm());
  return max;
}

TEST(RefineCorners, moves_inexact_corners_back_to_the_edges) {
  const GreyImage picture = painted_tag(7, kPose, kLens);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> off(-0.5, 0.5);
  for (int i = 0; i < 100; ++i) {
    Corners corners = true_corners();
    for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(off(random), off(random));
    EXPECT_LT(farthest(refine_corners(picture, corners, kCells).positions, true_corners()), 0.12);
  }
}

TEST(RefineCorners, is_robust_against_a_finger_on_the_edge) {
  GreyImage picture = painted_tag(7, kPose, kLens);
  const Corners truth = true_corners();
  const Eigen::Vector2d middle = 0.5 * (truth[0] + truth[1]);
  for (int y = -6; y <= 6; ++y) {
    for (int x = -6; x <= 6; ++x) *picture.at(static_cast<int>(middle.x()) + x, static_cast<int>(middle.y()) + y) = 140;
  }
  EXPECT_LT(farthest(refine_corners(picture, truth, kCells).positions, truth), 0.3);
}

TEST(RefineCorners, has_a_consistent_covariance) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 4.0);
  const GreyImage clean = painted_tag(7, kPose, kLens);
  const Corners truth = true_corners();
  double squares = 0.0;
  constexpr int kTimes = 100;
  for (int i = 0; i < kTimes; ++i) {
    GreyImage picture = clean;
    for (std::uint8_t& grey : picture.data()) {
      grey = static_cast<std::uint8_t>(std::clamp(std::lround(grey + noise(random)), 0L, 255L));
    }
    const RefinedCorners refined = refine_corners(picture, truth, kCells);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d error = refined.positions[k] - truth[k];
      squares += error.dot(refined.covariance[k].inverse() * error) / (8.0 * kTimes);
    }
  }
  // Mean square error in units of the covariance; 1 if it is right.
  EXPECT_GT(squares, 0.2);
  EXPECT_LT(squares, 3.0);
}

TEST(RefineCorners, does_not_move_corners_where_there_is_no_edge) {
  const GreyImage flat(640, 480, 90);
  EXPECT_EQ(refine_corners(flat, true_corners(), kCells).positions, true_corners());
  EXPECT_EQ(refine_corners(GreyImage(), true_corners(), kCells).positions, true_corners());
  EXPECT_EQ(refine_corners(GreyImage(1, 1), true_corners(), kCells).positions, true_corners());
}

TEST(RefineCorners, returns_finite_corners_nearby_for_any_corners) {
  const GreyImage picture = painted_tag(7, kPose, kLens);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-100.0, 800.0);
  for (int i = 0; i < 5000; ++i) {
    Corners corners;
    for (Eigen::Vector2d& corner : corners) corner = {any(random), any(random)};
    if (i % 7 == 0) corners[1] = corners[0];
    const RefinedCorners refined = refine_corners(picture, corners, kCells);
    EXPECT_LE(farthest(refined.positions, corners), 2.0);
    for (const Eigen::Matrix2d& covariance : refined.covariance) EXPECT_TRUE(covariance.allFinite());
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Corners broken = true_corners();
  broken[2] = {nan, nan};
  const Corners refined = refine_corners(picture, broken, kCells).positions;
  EXPECT_EQ(refined[0], broken[0]);
}

}  // namespace
}  // namespace cyclorama::tags
