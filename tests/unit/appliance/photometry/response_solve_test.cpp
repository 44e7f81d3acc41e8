// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/response_solve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/data_sets/even_light.h"

namespace cyclorama::photometry {
namespace {

using ::testing::HasSubstr;

/// Returns the largest error of a measured point, relative to full scale.
double worst_error(const EvenLight& light) {
  const auto solved = solve_responses(even_light({light}));
  EXPECT_TRUE(solved) << (solved ? "" : solved.error().message());
  if (!solved) return 1.0;
  double worst = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (const ResponsePoint& point : solved->channels[0].at(c))
      worst = std::max(worst, std::abs(point.light - light.projector.at(c)(point.level)));
  }
  return std::isfinite(worst) ? worst : 1.0;
}

EvenLight of_gamma(double gamma) {
  EvenLight light;
  light.projector.fill([gamma](double x) { return std::pow(x, gamma); });
  return light;
}

TEST(SolveResponses, finds_gammas_from_1_to_4_with_a_linear_camera) {
  for (const double gamma : {1.0, 1.8, 2.2, 4.0}) EXPECT_LT(worst_error(of_gamma(gamma)), 5e-4) << gamma;
}

TEST(SolveResponses, finds_them_for_any_response_of_the_camera) {
  for (const double camera : {0.45, 0.8, 1.05, 1.2}) {
    EvenLight light = of_gamma(2.2);
    light.camera = [camera](double x) { return std::pow(x, camera); };
    EXPECT_LT(worst_error(light), 4e-3) << camera;
    light.camera = [](double x) { return x + 0.08 * x * (1.0 - x) * (1.0 - 2.0 * x); };
    EXPECT_LT(worst_error(light), 4e-3);
  }
}

TEST(SolveResponses, finds_the_cameras_response_up_to_a_factor) {
  EvenLight light;
  light.camera = [](double x) { return std::pow(x, 0.8); };
  const auto solved = solve_responses(even_light({light}));
  ASSERT_TRUE(solved);
  const auto truth = [&light](double code) { return std::pow(code, 1.25) - light.pedestal; };
  for (const double code : {0.05, 0.2, 0.4, 0.6, 0.8})
    EXPECT_NEAR(solved->camera.light_of(code), truth(code) / truth(1.0), 6e-3) << code;
  EXPECT_NEAR(solved->camera.dark_code(), std::pow(light.pedestal, 0.8), 3e-3);
}

TEST(SolveResponses, handles_channels_and_projectors_that_differ) {
  EvenLight left;
  left.projector = {[](double x) { return std::pow(x, 1.6); },
                    [](double x) { return std::pow(x, 2.2) + 0.1 * x * (1.0 - x) * (1.0 - 2.0 * x); },
                    [](double x) { return x; }};
  EvenLight right = of_gamma(3.0);
  right.brightness = 0.1;
  const auto solved = solve_responses(even_light({left, right}));
  ASSERT_TRUE(solved);
  for (std::size_t p = 0; p < 2; ++p) {
    const EvenLight& truth = p == 0 ? left : right;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const ResponsePoint& point : solved->channels[p].at(c))
        EXPECT_NEAR(point.light, truth.projector.at(c)(point.level), 1e-3) << p << ' ' << c << ' ' << point.level;
    }
  }
}

TEST(SolveResponses, loses_less_than_half_a_percent_to_noise_and_eight_bits) {
  EvenLight light;
  light.noise = 1e-3;
  EXPECT_LT(worst_error(light), 2e-3);
  light.noise = 3e-4;
  light.bits = 8;
  EXPECT_LT(worst_error(light), 5e-3);
}

TEST(SolveResponses, is_robust_against_a_passer_by) {
  EvenLight light;
  light.noise = 3e-4;
  light.disturbed = 0.03;
  EXPECT_LT(worst_error(light), 5e-3);
}

TEST(SolveResponses, measures_a_dark_projector_as_long_as_it_is_visible) {
  EvenLight light;
  light.brightness = 0.02;
  light.noise = 1e-4;
  EXPECT_LT(worst_error(light), 5e-3);
}

std::string refusal(const PhotometryInput& input) {
  const auto solved = solve_responses(input);
  return solved ? "solved" : solved.error().message();
}

TEST(SolveResponses, names_a_channel_without_light) {
  EvenLight light;
  light.channel_light = {1.0, 0.0, 1.0};
  EXPECT_THAT(refusal(even_light({EvenLight{}, light})),
              HasSubstr("projector 'right' gives no green light; look after"));
  light.channel_light = {0.0, 0.0, 0.0};
  EXPECT_THAT(refusal(even_light({light})), HasSubstr("projector 'left' gives no light"));
}

TEST(SolveResponses, refuses_undetermined_responses_and_says_what_to_photograph) {
  EvenLight light;
  light.exposures = {1.0};
  EXPECT_THAT(refusal(even_light({light})), HasSubstr("with a second one"));
  light = {};
  light.brightness = 30.0;
  EXPECT_THAT(refusal(even_light({light})), HasSubstr("shorten the exposure"));
  PhotometryInput input = even_light({EvenLight{}});
  input.views.clear();
  EXPECT_THAT(refusal(input), HasSubstr("there is no ramp of its red, green and blue"));
}

}  // namespace
}  // namespace cyclorama::photometry
