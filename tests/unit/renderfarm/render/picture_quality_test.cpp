// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/picture_quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace cyclorama::render {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string refusal_of(const std::function<void(PictureQuality*)>& turn) {
  PictureQuality quality;
  turn(&quality);
  const Status status = validate(quality);
  if (status) return "none";
  EXPECT_EQ(status.error().code(), ErrorCode::kInvalidArgument);
  return status.error().message();
}

TEST(PictureQuality, has_valid_defaults) { EXPECT_TRUE(validate(PictureQuality{})); }

TEST(PictureQuality, names_a_setting_out_of_range_with_its_range) {
  EXPECT_EQ(refusal_of([](auto* q) { q->scale = 1.5; }), "scale is 1.5; it must be 0.125 to 1");
  EXPECT_THAT(refusal_of([](auto* q) { q->scale = 0.0; }), HasSubstr("scale"));
  EXPECT_THAT(refusal_of([](auto* q) { q->scale = kNan; }), HasSubstr("scale"));
  EXPECT_THAT(refusal_of([](auto* q) { q->jpeg_quality = 0; }), HasSubstr("jpeg_quality"));
  EXPECT_THAT(refusal_of([](auto* q) { q->jpeg_quality = 101; }), HasSubstr("jpeg_quality"));
}

TEST(PictureQuality, checks_the_render_settings_too) {
  EXPECT_THAT(refusal_of([](auto* q) { q->render.samples = 0; }), HasSubstr("samples"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.first_sample = kMaxSamples; }), HasSubstr("first_sample"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.bounces = -1; }), HasSubstr("bounces"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.light_samples = 0; }), HasSubstr("light_samples"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.firefly_limit = static_cast<float>(kNan); }), HasSubstr("firefly"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.adaptive_error = -1.0f; }), HasSubstr("adaptive_error"));
  EXPECT_THAT(refusal_of([](auto* q) { q->render.adaptive_minimum = 1; }), HasSubstr("adaptive_minimum"));
}

}  // namespace
}  // namespace cyclorama::render
