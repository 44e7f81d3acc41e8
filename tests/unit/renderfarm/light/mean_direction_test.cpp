// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/mean_direction.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama::light {
namespace {

using Eigen::Vector3f;

TEST(MeanDirection, survives_its_code_within_a_tenth_of_a_degree) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1000; ++i) {
    const Vector3f direction = Vector3f(normal(random), normal(random), normal(random)).normalized();
    const float length = static_cast<float>(i % 255 + 1) / 255.0f;
    const Vector3f again = from_direction_code(to_direction_code(length * direction));
    EXPECT_NEAR(again.norm(), length, 1e-3f);
    EXPECT_GT(again.normalized().dot(direction), 1.0f - 1.5e-6f);
  }
}

TEST(MeanDirection, has_no_direction_for_what_has_none) {
  EXPECT_TRUE(from_direction_code(to_direction_code(Vector3f::Zero())).isZero());
  EXPECT_TRUE(
      from_direction_code(to_direction_code(Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()))).isZero());
}

TEST(BentShare, follows_the_cosine_of_a_single_lamp) {
  const Vector3f lamp = Vector3f(0.6f, 0.0f, 0.8f);
  const Vector3f bent = Vector3f(0.3f, 0.1f, 0.9f).normalized();
  EXPECT_NEAR(bent_share(lamp, Vector3f::UnitZ(), bent), bent.dot(lamp) / 0.8f, 1e-6f);
}

TEST(BentShare, is_near_that_of_an_even_sky) {
  // The irradiance-weighted mean direction of a hemisphere of even light is two thirds of its axis.
  for (const float tilt : {0.0f, 0.3f, 0.6f}) {
    const Vector3f bent(std::sin(tilt), 0.0f, std::cos(tilt));
    EXPECT_NEAR(bent_share(Vector3f::UnitZ() * (2.0f / 3.0f), Vector3f::UnitZ(), bent), 0.5f + 0.5f * bent.z(), 0.03f);
  }
}

TEST(BentShare, is_bounded_and_never_negative) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  const auto unit = [&] { return Vector3f(normal(random), normal(random), normal(random)).normalized(); };
  for (int i = 0; i < 1000; ++i) {
    const float share = bent_share(unit(), unit(), unit());
    EXPECT_GE(share, 0.0f);
    EXPECT_LE(share, 4.0f);
  }
  EXPECT_EQ(bent_share(Vector3f::Zero(), unit(), unit()), 1.0f);
}

}  // namespace
}  // namespace cyclorama::light
