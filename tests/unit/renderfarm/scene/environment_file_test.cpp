// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/environment_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "common/image/pfm.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class EnvironmentFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("environment_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path written(const RadianceImage& pixels) const {
    EXPECT_TRUE(write_pfm(folder_ / "light.pfm", pixels).has_value());
    return folder_ / "light.pfm";
  }
  /// Loads a triangle under light.pfm, with `more` in its scene.toml.
  [[nodiscard]] Result<Scene> package(const std::string& more) const {
    std::ofstream(folder_ / "a.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(folder_ / "scene.toml") << "title = 'x'\n"
                                          << more
                                          << "[[geometry]]\nfile = 'a.obj'\n[environment]\nfile = 'light.pfm'\n"
                                             "strength = 2\nrotation_deg = 180\n";
    return load_scene(folder_, {}, nullptr);
  }
  std::filesystem::path folder_;
};

RadianceImage noise(int width, int height) {
  RadianceImage image(width, height);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.0f, 10.0f);
  for (float& v : image.data()) v = value(random);
  return image;
}

TEST_F(EnvironmentFileTest, halving_keeps_the_total_light) {
  for (const auto& [width, height] : {std::pair{64, 32}, std::pair{1, 1}, std::pair{2, 1}}) {
    const EnvironmentMap whole{noise(width, height), 0.0f, 1.0f};
    const EnvironmentMap half{halved_environment(whole.pixels), 0.0f, 1.0f};
    EXPECT_EQ(half.pixels.width(), (width + 1) / 2);
    EXPECT_TRUE(mean_radiance(half).isApprox(mean_radiance(whole), 1e-5f)) << width;
  }
}

TEST_F(EnvironmentFileTest, the_mean_weights_texels_by_solid_angle) {
  RadianceImage pole(40, 20);
  for (int x = 0; x < 40; ++x) pole.at(x, 0)[1] = 1.0f;  // The top 9 degrees.
  const double cap = 0.5 * (1.0 - std::cos(std::numbers::pi / 20));
  EXPECT_NEAR(mean_radiance({pole, 0.0f, 3.0f}).y(), 3.0 * cap, 1e-6);
  EXPECT_EQ(mean_radiance({pole, 0.0f, 3.0f}).x(), 0.0f);
}

TEST_F(EnvironmentFileTest, a_map_that_is_too_wide_is_halved_with_a_note) {
  std::vector<std::string> notes;
  const auto pixels = read_environment(written(RadianceImage(4098, 2049, 2.0f)), {}, &notes);
  ASSERT_TRUE(pixels.has_value()) << pixels.error().message();
  EXPECT_EQ(pixels->width(), 2049);
  EXPECT_EQ(pixels->height(), 1025);
  EXPECT_EQ(pixels->at(2048, 1024)[0], 2.0f);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("4098x2049 pixels is taken as 2049x1025")));
}

TEST_F(EnvironmentFileTest, another_shape_or_size_and_a_missing_file_are_refused_by_name) {
  std::vector<std::string> notes;
  const auto square = read_environment(written(noise(8, 8)), {}, &notes);
  ASSERT_FALSE(square.has_value());
  EXPECT_THAT(square.error().message(), HasSubstr("light.pfm"));
  EXPECT_THAT(square.error().message(), HasSubstr("twice as wide as high"));
  ImportLimits limits;
  limits.texture_px = 127;
  EXPECT_FALSE(read_environment(written(noise(16, 8)), limits, &notes).has_value());
  limits.texture_px = 128;
  EXPECT_TRUE(read_environment(written(noise(16, 8)), limits, &notes).has_value());
  EXPECT_EQ(read_environment(folder_ / "none.hdr", limits, &notes).error().code(), ErrorCode::kNotFound);
}

TEST_F(EnvironmentFileTest, a_scene_without_other_light_is_exposed_by_its_mean) {
  for (const float light : {1e-3f, 1.0f, 5000.0f}) {
    written(RadianceImage(16, 8, light));
    const auto scene = package("");
    ASSERT_TRUE(scene.has_value()) << scene.error().message();
    ASSERT_NE(scene->environment, nullptr);
    EXPECT_EQ(scene->environment->strength, 2.0f);
    EXPECT_NEAR(scene->environment->rotation_rad, std::numbers::pi, 1e-6);
    // A surface that reflects half of the light has middle brightness, and no lamp was added.
    EXPECT_NEAR(scene->exposure * 0.5 * 2.0 * light, 0.25, 1e-3);
    EXPECT_TRUE(scene->model.lights.empty());
    EXPECT_TRUE(scene->eye_lamp.isZero());
  }
  const auto scene = package("exposure = 7.0\n");
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->exposure, 7.0);
  EXPECT_GE(scene->memory_bytes(), 16U * 8U * 3U * sizeof(float));
}

}  // namespace
}  // namespace cyclorama::scene
