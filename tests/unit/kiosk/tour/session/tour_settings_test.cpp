// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/tour_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace cyclorama::tour {
namespace {

using testing::HasSubstr;
constexpr double kDegree = std::numbers::pi / 180.0;

TEST(TourSettings, are_the_defaults_for_an_empty_file) {
  const auto settings = parse_tour_settings("", "site.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  const TourSettings defaults = default_tour_settings();
  EXPECT_EQ(settings->coordinators, defaults.coordinators);
  EXPECT_NEAR(settings->picture.guard_rad, defaults.picture.guard_rad, 1e-12);
  EXPECT_NEAR(settings->picture.guard_rad, 8.0 * kDegree, 0.1 * kDegree);
  EXPECT_NEAR(settings->navigation.limits.turn_rad_per_s, defaults.navigation.limits.turn_rad_per_s, 1e-12);
  EXPECT_EQ(settings->navigation.guide_after, defaults.navigation.guide_after);
}

TEST(TourSettings, ignore_the_displays_settings) {
  EXPECT_TRUE(parse_tour_settings("[display]\nx = 1\n[hours]\ny = 2\n", "site.toml"));
}

TEST(TourSettings, read_every_key_in_its_unit) {
  const auto settings = parse_tour_settings(R"(
[farm]
coordinators = ["[2001:db8::1]:7401", "[2001:db8::2]:7401"]
scene = "grotto"
museum = "Hall 3"
[picture]
samples = 4
jpeg_quality = 92
subsample_chroma = false
guard_deg = 12
[walk]
forward_m_per_s = 1.2
sideways_m_per_s = 0.5
turn_deg_per_s = 30
acceleration_m_per_s2 = 3
jerk_m_per_s3 = 30
turn_acceleration_deg_per_s2 = 120
turn_jerk_deg_per_s3 = 900
max_turn_minutes = 5
turn_pause_s = 3
neutral_distance_m = 1.5
neutral_right_m = -0.1
mark_distance_m = 2.5
mark_right_m = 0.2
lean_dead_deg = 4
lean_full_deg = 25
step_dead_m = 0.2
step_full_m = 0.6
approach_dead_m = 0.1
approach_full_m = 0.7
yaw_dead_deg = 5
yaw_full_deg = 40
sideways_dead_m = 0.05
sideways_full_m = 0.3
distance_dead_m = 0.1
distance_full_m = 0.5
tag_smoothing_ms = 80
guide_after_s = 0
)",
                                            "site.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->coordinators.size(), 2u);
  EXPECT_EQ(settings->museum, "Hall 3");
  EXPECT_EQ(settings->picture.frame_budget_ms, 0.0) << "the quality is fixed";
  EXPECT_EQ(settings->picture.jpeg_quality, 92);
  EXPECT_FALSE(settings->picture.subsample_chroma);
  EXPECT_NEAR(settings->picture.guard_rad, 12 * kDegree, 1e-12);
  EXPECT_NEAR(settings->navigation.limits.turn_rad_per_s, 30 * kDegree, 1e-12);
  EXPECT_NEAR(settings->navigation.tag.yaw_rad.full, 40 * kDegree, 1e-12);
  EXPECT_EQ(settings->navigation.body.mark_distance_m, 2.5);
  EXPECT_NEAR(settings->navigation.body.lean_rad.full, 25 * kDegree, 1e-12);
  EXPECT_EQ(settings->navigation.body.distance_m.full, 0.7);
  EXPECT_EQ(settings->navigation.tag_smoothing, std::chrono::milliseconds(80));
  EXPECT_EQ(settings->navigation.guide_after, Duration::zero());
  EXPECT_EQ(settings->navigation.limits.jerk_m_per_s3, 30.0);
  EXPECT_NEAR(settings->navigation.limits.turn_jerk_rad_per_s3, 900 * kDegree, 1e-12);
  EXPECT_EQ(settings->navigation.max_turn, std::chrono::minutes(5));
  EXPECT_EQ(settings->navigation.turn_pause, std::chrono::seconds(3));
}

TEST(TourSettings, use_a_frame_budget_unless_the_quality_is_fixed) {
  EXPECT_EQ(default_tour_settings().picture.frame_budget_ms, 150.0);
  EXPECT_EQ(parse_tour_settings("[picture]\nguard_deg = 1", "site.toml")->picture.frame_budget_ms, 150.0);
  EXPECT_EQ(parse_tour_settings("[picture]\nframe_budget_ms = 0", "site.toml")->picture.frame_budget_ms, 0.0);
  EXPECT_EQ(parse_tour_settings("[picture]\njpeg_quality = 60", "site.toml")->picture.frame_budget_ms, 0.0);
  const auto settings = parse_tour_settings("[picture]\nframe_budget_ms = 33\nreference_samples = 256", "site.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->picture.frame_budget_ms, 33.0);
  EXPECT_EQ(settings->picture.reference_samples, 256);
}

struct Wrong {
  const char* text;
  const char* line;
  const char* says;
};

TEST(TourSettings, name_line_and_remedy_of_every_mistake) {
  for (const Wrong& wrong : std::vector<Wrong>{
           {"[farm]\ncoordinators = []", "site.toml:2", "name the farm's coordinator"},
           {"[farm]\ncoordinators = [1]", "site.toml:2", "texts"},
           {"[picture]\nsamples = 0", "site.toml:2", "between 1 and 4096"},
           {"[picture]\njpeg_quality = 101", "site.toml:2", "between 1 and 100"},
           {"[picture]\nframe_budget_ms = -1", "site.toml:2", "between 0 and 60000"},
           {"[picture]\nframe_budget_ms = 50\nsamples = 2", "site.toml:2", "between 0 and 0"},
           {"[picture]\nreference_samples = 5000", "site.toml:2", "between 1 and 4096"},
           {"[picture]\nguard_rad = 1", "site.toml:2", "guard_deg"},
           {"[walk]\nforward_m_per_s = nan", "site.toml:2", "between"},
           {"[walk]\nforwards_m_per_s = 1", "site.toml:2", "did you mean 'forward_m_per_s'"},
           {"[walk]\nyaw_dead_deg = 50\nyaw_full_deg = 40", "site.toml:3", "must be above 'yaw_dead_deg'"},
           {"[walk]\nacceleration_m_per_s2 = 0.5", "site.toml:2", "lost tag"},
           {"[walk]\nturn_deg_per_s = 170", "site.toml:1", "lost tag"},
           {"[walk]\njerk_m_per_s3 = 3", "site.toml:1", "raise it or the jerk"},
           {"[walks]", "site.toml:1", "not a setting"},
           {"[walk\n", "site.toml:1", "not TOML"}}) {
    const auto settings = parse_tour_settings(wrong.text, "site.toml");
    ASSERT_FALSE(settings) << wrong.text;
    EXPECT_EQ(settings.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(settings.error().message(), HasSubstr(wrong.line));
    EXPECT_THAT(settings.error().message(), HasSubstr(wrong.says));
  }
}

TEST(TourSettings, name_the_museums_certificate_or_none) {
  EXPECT_FALSE(parse_tour_settings("", "site.toml")->tls);
  const auto settings =
      parse_tour_settings("[farm]\nauthority = \"/a\"\ncertificate = \"c\"\nkey = \"k\"", "site.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->tls, (TlsFiles{"/a", "c", "k"}));
  EXPECT_FALSE(parse_tour_settings("[farm]\nauthority = \"/a\"\nkey = \"k\"", "site.toml"));
}

TEST(TourSettings, name_a_missing_file) {
  const auto settings = read_tour_settings("/nowhere/site.toml");
  ASSERT_FALSE(settings);
  EXPECT_EQ(settings.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(settings.error().message(), HasSubstr("/nowhere/site.toml"));
}

}  // namespace
}  // namespace cyclorama::tour
