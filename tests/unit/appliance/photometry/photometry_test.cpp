// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/photometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/wall_light.h"
#include "tests/data_sets/even_light.h"
#include "tests/data_sets/photometry_museum.h"

namespace cyclorama::photometry {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool is_finite(const Photometry& photometry) {
  for (const PhotometricHead& head : photometry.heads) {
    for (const warp::MaskImage* image : {&head.mask, &head.weight}) {
      if (!std::ranges::all_of(image->data(), [](float v) { return v >= 0.0f && v <= 1.0f; })) return false;
    }
    if (head.colour.black_lift &&
        !std::ranges::all_of(head.colour.black_lift->data(), [](float v) { return v >= 0.0f && v <= 1.0f; })) {
      return false;
    }
    if (head.colour.matrix && !head.colour.matrix->allFinite()) return false;
    if (!head.colour.black.allFinite() || !head.primaries.allFinite() || !head.black.allFinite()) return false;
    for (const warp::ResponseCurve& curve : *head.colour.response) {
      if (!curve.is_valid()) return false;
    }
  }
  return std::isfinite(photometry.light_kept) && std::isfinite(photometry.camera_corner);
}

TEST(Photometry, changes_two_equal_projectors_only_where_they_overlap) {
  const auto result = photometry(even_light({EvenLight{}, EvenLight{}}));
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_TRUE(is_finite(*result));
  EXPECT_THAT(result->remarks, ElementsAre(HasSubstr("no place was seen from two stops")));
  EXPECT_NEAR(result->heads[0].brightness, result->heads[1].brightness, 2e-3);
  EXPECT_LT((*result->heads[0].colour.matrix - Eigen::Matrix3d::Identity()).norm(), 0.01);
  EXPECT_GT(result->light_kept, result->light_kept_flat);
}

TEST(Photometry, adds_up_to_a_smooth_target) {
  EvenLight dim;
  dim.brightness = 0.15;
  PhotometryInput input = even_light({EvenLight{}, dim});
  PhotometryOptions options;
  const auto result = photometry(input, options);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_NEAR(result->heads[1].brightness, 0.15 / 0.24, 0.01);
  // Sums both projectors' light along the horizon.
  const auto left = *InverseMap::make(input.projectors[0].map);
  const auto right = *InverseMap::make(input.projectors[1].map);
  double before = 0.0;
  for (double azimuth = -33.0; azimuth <= 33.0; azimuth += 0.25) {
    const double angle = azimuth * 3.14159265 / 180.0;
    const Eigen::Vector3d direction(std::sin(angle), 0.0, -std::cos(angle));
    double sum = 0.0;
    for (std::size_t p = 0; p < 2; ++p) {
      const auto pixel = (p == 0 ? left : right).pixel_at(direction);
      if (!pixel) continue;
      const double u = pixel->x() / 320.0 - 0.5;
      const double v = pixel->y() / 200.0 - 0.5;
      const double gain = (p == 0 ? 0.24 : 0.15) * (1.0 - 0.8 * (u * u + v * v));
      const double x = std::clamp(pixel->x() - 0.5, 0.0, 318.999);
      const int y = std::clamp(static_cast<int>(pixel->y()), 0, 199);
      const auto mask = [&](int column) { return static_cast<double>(*result->heads[p].mask.at(column, y)); };
      const int column = static_cast<int>(x);
      sum += gain * ((column + 1 - x) * mask(column) + (x - column) * mask(column + 1));
    }
    if (before > 0.0) {
      EXPECT_LT(std::abs(std::log(sum / before)), 0.25 * options.max_slope_per_deg + 0.006) << azimuth;
    }
    before = sum;
  }
}

TEST(Photometry, names_the_problem_of_a_projector) {
  EvenLight clipped;
  clipped.projector[0] = [](double x) { return std::pow(std::min(x / 0.85, 1.0), 2.2); };
  EvenLight dim;
  dim.brightness = 0.05;
  dim.black_level = 0.01;
  const auto result = photometry(even_light({clipped, dim}));
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_TRUE(is_finite(*result));
  EXPECT_THAT(result->remarks, Contains(HasSubstr("projector 'left', red: code values above")));
  EXPECT_THAT(result->remarks, Contains(HasSubstr("projector 'right' gives 2")));
  EXPECT_THAT(result->remarks, Contains(HasSubstr("projector 'right': its black is 1/")));
}

TEST(Photometry, leaves_colours_alone_with_a_grey_camera_and_reports_it) {
  PhotometryInput input = even_light({EvenLight{}, EvenLight{}});
  input.has_colour = false;
  const auto result = photometry(input);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_TRUE(is_finite(*result));
  EXPECT_FALSE(result->heads[0].colour.matrix);
  EXPECT_THAT(result->remarks, Contains(HasSubstr("use a colour camera")));
}

TEST(Photometry, keeps_nearly_all_light_of_a_single_projectors_middle) {
  const auto result = photometry(even_light({EvenLight{}}));
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_TRUE(is_finite(*result));
  EXPECT_EQ(*result->heads[0].weight.at(160, 100), 1.0f);
  EXPECT_NEAR(result->heads[0].black.y(), 5e-4, 3e-4);
}

/// Returns the vignetting of a lens about its optical axis.
double darkened(const Eigen::Vector2d& camera_px, const Eigen::Vector2d& centre_px, double exponent) {
  constexpr double kFocal_px = 400.0;
  return std::pow(1.0 + (camera_px - centre_px).squaredNorm() / (kFocal_px * kFocal_px), -0.5 * exponent);
}

/// Returns one projector, its left two thirds seen from one stop and its right two thirds from another.
PhotometryInput seen_from_two_stops(const Eigen::Vector2d& centre_px, double exponent) {
  EvenLight dark;
  dark.ambient = 0.0;
  PhotometryInput input = even_light({dark});
  input.views.push_back(input.views.front());
  for (std::size_t v = 0; v < 2; ++v) {
    ProjectorView& view = input.views[v];
    for (std::size_t i = 0; i < view.cells.cells.size(); ++i) {
      CameraCells::Cell& cell = view.cells.cells[i];
      cell.camera_px.x() = 1.4 * cell.projector_px.x() + (v == 0 ? 20.0 : -90.0);
      const bool is_seen = cell.camera_px.x() > 0.0 && cell.camera_px.x() < input.camera_width_px;
      if (!is_seen) cell.pixels = 0;
      for (LightReading& reading : view.readings) {
        for (std::size_t c = 0; c < 3; ++c) {
          float& code = reading.codes[i].code.at(c);
          code = static_cast<float>(0.01 +
                                    (static_cast<double>(code) - 0.01) * darkened(cell.camera_px, centre_px, exponent));
          if (!is_seen) reading.codes[i].is_clipped.at(c) = true;
        }
      }
    }
  }
  return input;
}

/// Returns the error of a projector's light, up to a common factor.
double off(const PhotometryInput& input) {
  const auto result = photometry(input);
  EXPECT_TRUE(result) << result.error().message();
  if (!result) return 1.0;
  double min = 1e9;
  double max = -1e9;
  for (int x = 20; x <= 300; x += 10) {
    for (int y = 20; y <= 180; y += 10) {
      const double error =
          result->lighting->projectors[0].log_white.at(Eigen::Vector2d(x, y)) - std::log(gain_at(x / 320.0, y / 200.0));
      min = std::min(min, error);
      max = std::max(max, error);
    }
  }
  return max - min;
}

TEST(Photometry, separates_a_projectors_light_from_the_cameras_vignetting) {
  const Eigen::Vector2d centre(214.0, 143.0);
  const double without = off(seen_from_two_stops(centre, 0.0));
  PhotometryInput input = seen_from_two_stops(centre, 3.0);
  EXPECT_GT(off(input), without + 0.01) << "taken for the middle it must matter, or this test is of nothing";
  input.camera_centre_px = centre;
  EXPECT_LT(off(input), without + 0.002);
  input.camera_centre_px = {-1.0, 150.0};
  EXPECT_FALSE(photometry(input));
}

TEST(Photometry, refuses_invalid_input) {
  PhotometryInput input = even_light({EvenLight{}});
  PhotometryOptions options;
  options.max_slope_per_deg = -1.0;
  EXPECT_FALSE(photometry(input, options));
  options.max_slope_per_deg = 0.02;
  options.max_slope_at_borders_per_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(photometry(input, options));
  EXPECT_FALSE(photometry({}));
  input.views[0].readings[3].codes.pop_back();
  EXPECT_FALSE(photometry(input));
  input = even_light({EvenLight{}});
  input.views[0].projector = 3;
  EXPECT_FALSE(photometry(input));
  input = even_light({EvenLight{}});
  input.projectors[0].map.directions.clear();
  const auto refused = photometry(input);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("projector 'left'"));
}

// With four projectors the pictures are less high than the wall, so that corners lie on it.
TEST(Photometry, evens_out_a_simulated_museums_wall) {
  simulated::PresetOptions small;
  small.projectors = 4;
  small.projector_width_px = 480;
  small.projector_height_px = 270;
  small.camera_megapixels = 0.1;
  auto preset = simulated::make_preset("cylinder126", 3, small);
  ASSERT_TRUE(preset);
  auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
  ASSERT_TRUE(museum);
  MuseumLightOptions scan;
  scan.cell_px = 16;
  scan.angles_deg = {-36.0, 0.0, 36.0};
  const auto scanned = photograph_light(&*museum, scan);
  ASSERT_TRUE(scanned) << scanned.error().message();
  const auto result = photometry(scanned->input);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_TRUE(is_finite(*result));
  EXPECT_LT(response_rms(museum->truth(), *result), 0.005);
  // Pixels are four times as large as in full HD, and so is the margin at the rim that is not scored.
  const SeamScore score = seam_score(museum->truth(), *result, true, 0.8);
  EXPECT_GT(score.pairs, 40u);
  EXPECT_LT(score.mask_sum_error, 0.005);
  EXPECT_LT(score.step_p95, 0.01);
  EXPECT_LT(score.jump_p95, 0.01);
  EXPECT_LT(score.delta_e_mean, 0.8);
  EXPECT_LT(score.delta_e_p95, 1.5);
  EXPECT_GT(seam_score(museum->truth(), *result, false).delta_e_p95, score.delta_e_p95);
}

}  // namespace
}  // namespace cyclorama::photometry
