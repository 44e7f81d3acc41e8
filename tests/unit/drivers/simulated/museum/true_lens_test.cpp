// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_lens.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::simulated {
namespace {

const Pinhole kPinhole{1920, 1080, 1500.0, 980.0, 300.0};

TEST(TrueLens, without_distortion_it_is_a_pinhole) {
  const TrueLens lens(kPinhole);
  const Eigen::Vector3d point(0.3, -0.1, 2.0);
  EXPECT_LT((*lens.pixel_of(point) - *kPinhole.pixel_of(point)).norm(), 1e-12);
  EXPECT_FALSE(lens.pixel_of({0.1, 0.1, -1.0}));
}

TEST(TrueLens, agrees_with_opencv_for_a_known_point) {
  // cv2.projectPoints of (0.4, 0.3, 1), f = 1500, c = (979.5, 299.5), k1 k2 p1 p2 k3 = -0.1 0.02 0.001 -0.002 0.005,
  // whose first pixel's centre is (0, 0). Computed by hand: r^2 = 0.25, radial 0.976328125,
  // x = 0.4 * 0.976328125 + 2 * 0.001 * 0.12 - 0.002 * (0.25 + 0.32) = 0.38963125,
  // y = 0.3 * 0.976328125 + 0.001 * (0.25 + 0.18) - 2 * 0.002 * 0.12 = 0.2928484375.
  const TrueLens lens(kPinhole, {-0.1, 0.02, 0.005}, {0.001, -0.002});
  const Eigen::Vector2d pixel = *lens.pixel_of({0.4, 0.3, 1.0});
  EXPECT_NEAR(pixel.x(), 980.0 + 1500.0 * 0.38963125, 1e-9);
  EXPECT_NEAR(pixel.y(), 300.0 + 1500.0 * 0.2928484375, 1e-9);
}

TEST(TrueLens, has_the_derivative_of_differences) {
  const TrueLens lens(kPinhole, {-0.1, 0.02, 0.005}, {0.001, -0.002});
  constexpr double kStep = 1e-6;
  for (const Eigen::Vector2d& at :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.4, -0.2), Eigen::Vector2d(-0.1, 0.5)}) {
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Vector2d step = Eigen::Vector2d::Zero();
      step[axis] = kStep;
      const Eigen::Vector2d difference = (lens.distorted(at + step) - lens.distorted(at - step)) / (2.0 * kStep);
      EXPECT_LT((difference - lens.derivative(at).col(axis)).norm(), 1e-9);
    }
  }
}

// Guards against a fixed number of iterations: each pixel is inverted to within 1e-9, or has no ray.
TEST(TrueLens, every_pixel_is_inverted_or_has_no_ray) {
  for (const double k1 : {-0.5, -0.3, -0.1, 0.0, 0.2, 0.8}) {
    for (const double k2 : {-0.1, 0.0, 0.15}) {
      const TrueLens lens(kPinhole, {k1, k2, 0.0}, {0.0005, -0.0008});
      int refused = 0;
      for (int v = -400; v <= 1480; v += 47) {
        for (int u = -400; u <= 2320; u += 61) {
          const auto direction = lens.direction_at(u, v);
          if (!direction) {
            ++refused;
            continue;
          }
          ASSERT_TRUE(direction->allFinite());
          const auto back = lens.pixel_of(*direction);
          ASSERT_TRUE(back);
          EXPECT_LT((*back - Eigen::Vector2d(u, v)).norm(), 1e-9);
        }
      }
      // Pincushion distortion without a turning point has a ray for every pixel.
      if (k1 >= 0.0 && k2 >= 0.0) {
        EXPECT_EQ(refused, 0) << k1 << " " << k2;
      }
    }
  }
}

TEST(TrueLens, images_nothing_beyond_its_turning_point) {
  const TrueLens lens(kPinhole, {-0.4, 0.0, 0.0});
  const double turning = std::sqrt(1.0 / 1.2);  // 1 + 3 k1 r^2 = 0
  EXPECT_NEAR(lens.max_tangent(), turning, 1e-9);
  EXPECT_TRUE(lens.pixel_of({0.99 * turning, 0.0, 1.0}));
  EXPECT_FALSE(lens.pixel_of({1.01 * turning, 0.0, 1.0}));
  const double farthest = turning * (1.0 - 0.4 * turning * turning);
  EXPECT_TRUE(lens.direction_at(980.0 + 1500.0 * 0.999 * farthest, 300.0));
  EXPECT_FALSE(lens.direction_at(980.0 + 1500.0 * 1.001 * farthest, 300.0));
}

}  // namespace
}  // namespace cyclorama::simulated
