// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/channel_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace cyclorama::photometry {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<ResponsePoint> ramp_of(const std::function<double(double)>& curve, int steps = 17) {
  std::vector<ResponsePoint> points;
  for (int i = 0; i < steps; ++i) {
    const double level = static_cast<double>(i) / (steps - 1);
    points.push_back({level, curve(level), 1e-4});
  }
  return points;
}

double rms_against(const ChannelResponse& response, const std::function<double(double)>& curve) {
  double sum = 0.0;
  for (int code = 0; code < 256; ++code)
    sum += std::pow(response.light_of(code / 255.0) - curve(code / 255.0), 2) / 256;
  return std::sqrt(sum);
}

TEST(ChannelResponse, follows_gammas_from_1_to_4_between_its_points) {
  for (const double gamma : {1.0, 1.8, 2.2, 2.6, 4.0}) {
    const auto curve = [gamma](double x) { return std::pow(x, gamma); };
    const auto response = channel_response(ramp_of(curve));
    ASSERT_TRUE(response);
    EXPECT_LT(rms_against(*response, curve), 1e-3) << gamma;
    EXPECT_THAT(remarks_on(*response, "it"), IsEmpty()) << gamma;
  }
}

TEST(ChannelResponse, follows_s_shaped_curves) {
  for (const double bend : {-0.1, 0.12, 0.3}) {
    const auto curve = [bend](double x) { return std::pow(x, 2.2) + bend * x * (1.0 - x) * (1.0 - 2.0 * x); };
    const auto response = channel_response(ramp_of(curve));
    ASSERT_TRUE(response);
    EXPECT_LT(rms_against(*response, [&](double x) { return std::max(0.0, curve(x)); }), 2.5e-3) << bend;
  }
}

TEST(ChannelResponse, has_an_inverse_that_gives_the_wanted_light) {
  for (const double gamma : {1.0, 2.2, 4.0}) {
    const auto curve = [gamma](double x) { return std::pow(x, gamma); };
    const auto response = channel_response(ramp_of(curve));
    ASSERT_TRUE(response);
    const warp::ResponseCurve inverse = response->inverse();
    ASSERT_TRUE(inverse.is_valid());
    for (double light = 0.0; light <= 1.0; light += 0.01)
      EXPECT_NEAR(response->light_of(inverse.code_of(light)), light, 2e-3) << gamma;
  }
}

TEST(ChannelResponse, detects_clipping_and_follows_the_kink) {
  for (const double clip : {0.7, 0.85, 0.9}) {
    const auto curve = [clip](double x) { return std::pow(std::min(x / clip, 1.0), 2.2); };
    const auto response = channel_response(ramp_of(curve));
    ASSERT_TRUE(response);
    ASSERT_TRUE(response->flat_above);
    EXPECT_NEAR(*response->flat_above, clip, 0.03);
    EXPECT_LT(rms_against(*response, curve), 5e-3);
    EXPECT_THAT(remarks_on(*response, "projector 'left', red"), ElementsAre(HasSubstr("shine no brighter; lower")));
  }
}

TEST(ChannelResponse, reports_a_channel_that_stays_black_and_one_that_decreases) {
  const auto crushed = channel_response(ramp_of([](double x) { return std::max(0.0, x - 0.3) / 0.7; }));
  ASSERT_TRUE(crushed);
  EXPECT_TRUE(crushed->dark_below);
  EXPECT_THAT(remarks_on(*crushed, "it"), ElementsAre(HasSubstr("stay black; raise")));

  const auto dip = [](double x) { return std::pow(x, 2.0) - 0.3 * std::exp(-std::pow((x - 0.8) / 0.06, 2)); };
  const auto falling = channel_response(ramp_of(dip));
  ASSERT_TRUE(falling);
  ASSERT_TRUE(falling->falls_at);
  EXPECT_NEAR(*falling->falls_at, 0.72, 0.07);
  EXPECT_THAT(remarks_on(*falling, "it"), ElementsAre(HasSubstr("it gets darker with growing code")));
  // Every light is produced by one of the codes in use, and the codes are monotone.
  const warp::ResponseCurve inverse = falling->inverse();
  for (double light = 0.0; light <= 1.0; light += 0.01)
    EXPECT_NEAR(falling->light_of(inverse.code_of(light)), light, 0.012) << light;
  EXPECT_TRUE(std::ranges::is_sorted(inverse.codes));
}

TEST(ChannelResponse, refuses_ramps_without_information) {
  EXPECT_FALSE(channel_response(ramp_of([](double) { return 0.0; })));
  EXPECT_FALSE(channel_response(ramp_of([](double x) { return x; }, 2)));
  auto twice = ramp_of([](double x) { return x; });
  twice[3].level = twice[2].level;
  EXPECT_FALSE(channel_response(twice));
  auto broken = ramp_of([](double x) { return x; });
  broken[3].light = std::numeric_limits<double>::quiet_NaN();
  const auto refused = channel_response(broken);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("photograph the ramp again"));
}

}  // namespace
}  // namespace cyclorama::photometry
