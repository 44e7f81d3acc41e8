// SPDX-License-Identifier: Apache-2.0
// Rays through splats against the equations in double.
#include "renderfarm/render/splats/splat_scene.h"

#include <gtest/gtest.h>

#include <deque>

#include "tests/data_sets/random_splats.h"

namespace cyclorama::render {
namespace {

constexpr double kCode = 1.0 / 255.0;
constexpr float kFar = std::numeric_limits<float>::infinity();

class SplatRays : public ::testing::Test {
 protected:
  void SetUp() override { device_ = rtcNewDevice("threads=1"); }
  void TearDown() override { rtcReleaseDevice(device_); }

  /// The scene borrows a copy of the cloud, which the fixture keeps.
  std::unique_ptr<SplatScene> built(const scene::SplatCloud& cloud,
                                    const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
    clouds_.push_back(cloud);
    auto scene = SplatScene::build(std::span(&clouds_.back(), 1), origin, device_);
    EXPECT_TRUE(scene.has_value()) << scene.error().message();
    return *std::move(scene);
  }

  RTCDevice device_ = nullptr;
  std::deque<scene::SplatCloud> clouds_;
};

struct RandomRay {
  Eigen::Vector3d eye;
  Eigen::Vector3d direction;
};

std::vector<RandomRay> random_rays(int count, double distance) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<RandomRay> rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d from =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized() * distance;
    const Eigen::Vector3d to = 0.5 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    rays.push_back({from, (to - from).normalized()});
  }
  return rays;
}

/// Returns the largest difference in code values.
double worst_code_error(const SplatScene& scene, const scene::SplatCloud& cloud, const std::vector<RandomRay>& rays) {
  const std::vector<ExactSplat> splats = exact_splats(cloud);
  double worst = 0.0;
  for (const RandomRay& ray : rays) {
    const SplatLight light = scene.trace(ray.eye.cast<float>(), ray.direction.cast<float>(), kFar);
    const SplatView exact = exact_view(cloud, splats, ray.eye, ray.direction, 1e9);
    worst = std::max({worst, (light.colour.cast<double>() - exact.colour).cwiseAbs().maxCoeff(),
                      std::abs(double{light.transmittance} - exact.transmittance)});
  }
  return worst / kCode;
}

TEST_F(SplatRays, agree_with_the_equations_within_a_code_for_each_degree) {
  for (int degree = 0; degree <= 3; ++degree) {
    const scene::SplatCloud cloud =
        random_splats({.count = 200, .degree = degree}, 11u + static_cast<unsigned>(degree));
    const auto scene = built(cloud);
    EXPECT_LE(worst_code_error(*scene, cloud, random_rays(400, 4.0)), 1.0) << degree;
  }
}

TEST_F(SplatRays, agree_from_within_the_splats) {
  const scene::SplatCloud cloud = random_splats({.count = 300}, 3);
  EXPECT_LE(worst_code_error(*built(cloud), cloud, random_rays(300, 0.4)), 1.0);
}

TEST_F(SplatRays, agree_where_more_splats_lie_on_a_ray_than_one_traversal_collects) {
  const scene::SplatCloud cloud =
      random_splats({.count = 3000, .degree = 0, .min_scale = 0.1, .max_scale = 0.5, .half_width = 0.5}, 5);
  EXPECT_LE(worst_code_error(*built(cloud), cloud, random_rays(100, 3.0)), 1.0);
}

TEST_F(SplatRays, agree_for_needles_and_discs_that_are_small_and_far) {
  scene::SplatCloud cloud = random_splats({.count = 400, .min_scale = 0.0005, .max_scale = 0.2}, 9);
  EXPECT_LE(worst_code_error(*built(cloud), cloud, random_rays(400, 30.0)), 1.0);
}

TEST_F(SplatRays, a_turned_stretched_and_mirrored_cloud_is_what_its_transform_says) {
  scene::SplatCloud cloud = random_splats({.count = 200}, 21);
  cloud.T_model_cloud = Eigen::Translation3d(0.2, -0.1, 0.3) *
                        Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()) *
                        Eigen::Scaling(Eigen::Vector3d(1.5, -0.7, 1.0));
  EXPECT_LE(worst_code_error(*built(cloud), cloud, random_rays(300, 5.0)), 1.0);
}

/// Small splats at some distance, where the derivative of the projection is nearly the projection.
TEST_F(SplatRays, agree_with_the_original_rasteriser_where_its_projection_is_exact) {
  scene::SplatCloud cloud =
      random_splats({.count = 60, .degree = 3, .min_scale = 0.01, .max_scale = 0.02, .half_width = 0.2}, 33);
  // One behind the other, so that both orders are the same: by depth, and along each ray.
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.positions[i][2] = 0.15f * static_cast<float>(i);
  const auto scene = built(cloud);
  const std::vector<ExactSplat> splats = exact_splats(cloud);
  const Eigen::Vector3d eye(0, 0, 30);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> across(-0.007, 0.007);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d direction = Eigen::Vector3d(across(random), across(random), -1.0).normalized();
    const SplatLight light = scene->trace(eye.cast<float>(), direction.cast<float>(), kFar);
    const SplatView original = rasterised_view(cloud, splats, eye, direction);
    EXPECT_LE((light.colour.cast<double>() - original.colour).cwiseAbs().maxCoeff(), kCode) << i;
  }
}

TEST_F(SplatRays, see_only_what_lies_before_their_end) {
  scene::SplatCloud cloud;
  const std::array<std::array<float, 3>, 1> white = {{{1.77f, 1.77f, 1.77f}}};
  for (const double z : {-2.0, -4.0}) {
    scene::SplatValues values;
    values.position = {0, 0, z};
    values.scale.setConstant(0.1);
    values.opacity = 0.5;
    ASSERT_TRUE(scene::add_splat(values, white, &cloud));
  }
  const auto scene = built(cloud);
  const Vec3 ahead = -Vec3::UnitZ();
  EXPECT_NEAR(scene->trace(Vec3::Zero(), ahead, kFar).transmittance, 0.25f, 1e-4f);
  EXPECT_NEAR(scene->trace(Vec3::Zero(), ahead, 3.0f).transmittance, 0.5f, 1e-4f);
  EXPECT_EQ(scene->trace(Vec3::Zero(), ahead, 1.0f).transmittance, 1.0f);
  EXPECT_EQ(scene->trace(Vec3::Zero(), -ahead, kFar).transmittance, 1.0f);
  EXPECT_NEAR(scene->trace(Vec3::Zero(), ahead, kFar).depth_m, 4.0f, 1e-4f) << "the first leaves half of the ray";
}

TEST_F(SplatRays, splats_at_one_place_are_all_blended_once) {
  scene::SplatCloud cloud;
  const std::array<std::array<float, 3>, 1> white = {{{1.77f, 1.77f, 1.77f}}};
  scene::SplatValues values;
  values.position = {0, 0, -2};
  values.scale.setConstant(0.1);
  values.opacity = 0.02;
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(scene::add_splat(values, white, &cloud));
  EXPECT_NEAR(built(cloud)->trace(Vec3::Zero(), -Vec3::UnitZ(), kFar).transmittance, std::pow(0.98, 200), 1e-4);
}

TEST_F(SplatRays, clouds_far_from_the_origin_keep_their_shape) {
  scene::SplatCloud cloud = random_splats({.count = 100, .min_scale = 0.01, .max_scale = 0.1}, 12);
  const scene::SplatCloud near_origin = cloud;
  const Eigen::Vector3d far_away(4e6, 100.0, -5e5);
  cloud.origin += far_away;
  const auto scene = built(cloud, far_away);
  EXPECT_LE(worst_code_error(*scene, near_origin, random_rays(200, 4.0)), 1.0);
}

}  // namespace
}  // namespace cyclorama::render
