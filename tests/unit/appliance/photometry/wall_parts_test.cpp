// SPDX-License-Identifier: Apache-2.0
// The parts of photometry(): inverse maps, weights, slow targets, gamuts and fields.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "appliance/photometry/blend_weights.h"
#include "appliance/photometry/common_gamut.h"
#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/light_cells.h"
#include "appliance/photometry/picture_field.h"
#include "appliance/photometry/slow_target.h"
#include "tests/data_sets/even_light.h"

namespace cyclorama::photometry {
namespace {

using ::testing::HasSubstr;
constexpr double kDegree = std::numbers::pi / 180.0;
const double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(InverseMap, finds_the_pixel_of_every_direction) {
  for (const double pan : {-2.8, -0.5, 0.0, 1.2}) {
    const calibration::MeasuredMap map = far_map(320, 200, 0.9, pan);
    const auto inverse = InverseMap::make(map);
    ASSERT_TRUE(inverse);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d pixel(320.0 * part(random), 200.0 * part(random));
      const auto found = inverse->pixel_at(*map.direction_at(pixel));
      ASSERT_TRUE(found) << pixel.transpose();
      EXPECT_LT((*found - pixel).norm(), 1e-6);
    }
    EXPECT_FALSE(inverse->pixel_at(-*map.direction_at({160.0, 100.0})));
    EXPECT_FALSE(inverse->pixel_at(Eigen::Vector3d(0.0, 1.0, 0.0)));
  }
}

TEST(InverseMap, is_empty_in_holes_and_refuses_invalid_maps) {
  calibration::MeasuredMap map = far_map(320, 200, 0.9, 0.0);
  const auto middle = *map.direction_at({160.0, 100.0});
  map.directions[static_cast<std::size_t>(5 * 17 + 8)] = Eigen::Vector3d::Constant(kNaN);
  const auto holed = InverseMap::make(map);
  ASSERT_TRUE(holed);
  EXPECT_FALSE(holed->pixel_at(middle));
  std::ranges::fill(map.directions, Eigen::Vector3d::Constant(kNaN));
  EXPECT_FALSE(InverseMap::make(map));
  map.directions.clear();
  EXPECT_FALSE(InverseMap::make(map));
}

std::vector<PhotometricProjector> two_projectors() {
  return {{"left", far_map(320, 200, 40.0 * kDegree, -15.0 * kDegree)},
          {"right", far_map(320, 200, 40.0 * kDegree, 15.0 * kDegree)}};
}

std::vector<InverseMap> inverses_of(const std::vector<PhotometricProjector>& projectors) {
  std::vector<InverseMap> inverses;
  for (const auto& projector : projectors) inverses.push_back(*InverseMap::make(projector.map));
  return inverses;
}

TEST(BlendWeights, add_up_to_one_and_are_continuous) {
  const auto projectors = two_projectors();
  const auto inverses = inverses_of(projectors);
  const BlendWeights weights(projectors, inverses);
  double before = 1.0;
  for (double azimuth = -34.0; azimuth <= 34.0; azimuth += 0.05) {
    const Eigen::Vector3d direction(std::sin(azimuth * kDegree), 0.02, -std::cos(azimuth * kDegree));
    const auto shares = weights.at(direction.normalized());
    ASSERT_FALSE(shares.empty()) << azimuth;
    double sum = 0.0;
    double left = 0.0;
    for (const auto& share : shares) {
      sum += share.weight;
      if (share.projector == 0) left = share.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_NEAR(left, before, 0.02) << azimuth;
    EXPECT_LE(left, before + 1e-9) << azimuth;
    before = left;
  }
  EXPECT_TRUE(weights.at(Eigen::Vector3d(0.0, 0.0, 1.0)).empty());
}

TEST(BlendWeights, fade_where_a_column_hides_the_wall_from_one_projector) {
  auto projectors = two_projectors();
  // The left picture ends inside the right one: its last three columns of control points are hidden.
  for (std::size_t y = 0; y <= 10; ++y) {
    for (std::size_t x = 14; x <= 16; ++x) projectors[0].map.directions[17 * y + x] = Eigen::Vector3d::Constant(kNaN);
  }
  const auto inverses = inverses_of(projectors);
  const BlendWeights weights(projectors, inverses);
  const auto left_at = [&](double x_px) {
    const Eigen::Vector2d pixel(x_px, 100.0);
    for (const auto& share : weights.at(*projectors[0].map.direction_at(pixel), 0, pixel)) {
      if (share.projector == 0) return share.weight;
    }
    return 0.0;
  };
  EXPECT_LT(left_at(259.9), 1e-3);
  EXPECT_GT(left_at(180.0), 0.5);
}

TEST(DirectionField, is_the_largest_field_below_the_available_light_with_that_slope) {
  const auto projectors = two_projectors();
  auto field = DirectionField::over(projectors, 0.5 * kDegree);
  ASSERT_TRUE(field);
  const Eigen::Vector3d dark = Eigen::Vector3d(0.2, 0.0, -1.0).normalized();
  const Eigen::Vector3d dim = Eigen::Vector3d(-0.3, 0.05, -1.0).normalized();
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::acos(std::min(1.0, a.dot(b)));
  };
  const auto reach = [&](const Eigen::Vector3d& d) {
    return angle(d, dark) < 0.008 ? 0.5 : angle(d, dim) < 0.008 ? 0.7 : 1.0;
  };
  field->fill(reach);
  const double slope = 0.02 / kDegree;
  const DirectionField slow = field->slow_below(slope, 0.0);
  for (double azimuth = -30.0; azimuth <= 30.0; azimuth += 1.3) {
    const Eigen::Vector3d d(std::sin(azimuth * kDegree), 0.03, -std::cos(azimuth * kDegree));
    const Eigen::Vector3d direction = d.normalized();
    // The expected cones in closed form.
    const double best =
        std::min({1.0, 0.5 * std::exp(slope * angle(direction, dark)), 0.7 * std::exp(slope * angle(direction, dim))});
    EXPECT_NEAR(slow.at(direction) / best, 1.0, 0.04) << azimuth;
  }
  // After smoothing the field stays below and keeps the slope.
  const DirectionField smooth = field->slow_below(slope, 1.0 * kDegree);
  double before = 0.0;
  for (double azimuth = -30.0; azimuth <= 30.0; azimuth += 0.1) {
    const Eigen::Vector3d d = Eigen::Vector3d(std::sin(azimuth * kDegree), 0.0, -std::cos(azimuth * kDegree));
    EXPECT_LE(smooth.at(d), reach(d) * 1.002);
    if (before > 0.0) {
      EXPECT_LE(std::abs(std::log(smooth.at(d) / before)), 1.1 * 0.02 * 0.1) << azimuth;
    }
    before = smooth.at(d);
  }
  // With slope 0 the field is as dark as the darkest point.
  EXPECT_NEAR(field->slow_below(0.0, 0.0).at(dim), 0.5, 1e-9);
}

TEST(DirectionField, varies_less_at_the_borders_of_pictures) {
  const auto projectors = two_projectors();
  auto field = DirectionField::over(projectors, 0.35 * kDegree);
  ASSERT_TRUE(field);
  const auto at = [](double azimuth) {
    return Eigen::Vector3d(std::sin(azimuth * kDegree), 0.0, -std::cos(azimuth * kDegree));
  };
  // Only left until -5 degrees, both until 5, only right until 30, then none; the last is no border between pictures.
  const auto near = field->near_borders(
      [](const Eigen::Vector3d& d) {
        const double azimuth = std::atan2(d.x(), -d.z()) / kDegree;
        return azimuth > 30.0 ? 0u : azimuth < -5.0 ? 1u : azimuth < 5.0 ? 3u : 2u;
      },
      2.0 * kDegree);
  const auto positions = field->positions();
  ASSERT_EQ(near.size(), positions.size());
  std::vector<double> slopes;
  for (const bool is_near : near) slopes.push_back((is_near ? 0.01 : 0.03) / kDegree);
  field->fill([](const Eigen::Vector3d& d) { return d.x() < -0.45 ? 0.3 : 1.0; });  // Dark until -27 degrees.
  const DirectionField slow = field->slow_below(slopes, 1.0 * kDegree);
  const auto slope = [&](double azimuth) { return std::log(slow.at(at(azimuth + 0.5)) / slow.at(at(azimuth - 0.5))); };
  EXPECT_NEAR(slope(-18.0), 0.03, 0.002);
  EXPECT_NEAR(slope(-5.0), 0.011, 0.0015);
  EXPECT_NEAR(slope(0.0), 0.03, 0.004);
  // Of the 52 degrees, 8 are near borders, so almost the full light is reached again.
  EXPECT_GE(slow.at(at(25.0)), 0.9);
}

TEST(DirectionField, works_on_a_full_circle_wall) {
  std::vector<PhotometricProjector> projectors;
  for (int i = 0; i < 6; ++i)
    projectors.push_back({"one of six", far_map(320, 200, 70.0 * kDegree, i * 60.0 * kDegree)});
  auto field = DirectionField::over(projectors, 0.5 * kDegree);
  ASSERT_TRUE(field);
  field->fill([](const Eigen::Vector3d& d) { return 1.0 + 0.1 * d.x(); });
  for (double azimuth = -180.0; azimuth <= 180.0; azimuth += 7.0) {
    const Eigen::Vector3d d(std::sin(azimuth * kDegree), 0.0, -std::cos(azimuth * kDegree));
    EXPECT_NEAR(field->slow_below(10.0, 0.0).at(d), 1.0 + 0.1 * d.x(), 2e-3) << azimuth;
  }
}

const Eigen::Vector3d kLuminance{0.2126, 0.7152, 0.0722};
Eigen::Matrix3d primaries_of(double red_in_green, double green_in_red, double blue) {
  Eigen::Matrix3d m;
  m << 1.0, red_in_green, 0.05, green_in_red, 1.0, 0.1, 0.02, 0.05, blue;
  return m / kLuminance.dot(m.rowwise().sum());
}

TEST(CommonGamut, is_a_single_projectors_own_gamut) {
  const std::vector<Eigen::Matrix3d> primaries = {primaries_of(0.2, 0.1, 1.0)};
  const std::vector<std::string> names = {"only"};
  const auto gamut = common_gamut(primaries, kLuminance, names);
  ASSERT_TRUE(gamut);
  EXPECT_NEAR(gamut->area_kept, 1.0, 1e-9);
  EXPECT_LT((gamut->matrices[0] - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_NEAR(gamut->kept[0], 1.0, 1e-9);
}

TEST(CommonGamut, gives_all_projectors_the_same_colours) {
  const std::vector<Eigen::Matrix3d> primaries = {primaries_of(0.2, 0.1, 1.0), primaries_of(0.3, 0.05, 0.8),
                                                  primaries_of(0.1, 0.2, 1.2)};
  const std::vector<std::string> names = {"a", "b", "c"};
  const auto gamut = common_gamut(primaries, kLuminance, names);
  ASSERT_TRUE(gamut);
  EXPECT_GT(gamut->area_kept, 0.5);
  for (const Eigen::Vector3d& content :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.2, 0.7, 0.4)}) {
    for (std::size_t p = 0; p < 3; ++p) {
      const Eigen::Vector3d channels = gamut->matrices[p] * content;
      EXPECT_GE(channels.minCoeff(), 0.0);
      EXPECT_LE(channels.maxCoeff(), 1.0 + 1e-12);
      const Eigen::Vector3d seen = primaries[p] * channels / gamut->kept[p];
      EXPECT_LT((seen - gamut->wall * content).norm(), 1e-9) << p;
    }
  }
  EXPECT_NEAR(kLuminance.dot(gamut->wall.rowwise().sum()), 1.0, 1e-12);
}

TEST(CommonGamut, refuses_projectors_without_colours_or_common_ones) {
  const std::vector<std::string> names = {"a", "b"};
  const std::vector<Eigen::Matrix3d> grey = {primaries_of(0.2, 0.1, 1.0), Eigen::Matrix3d::Ones()};
  const auto refused = common_gamut(grey, kLuminance, names);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("projector 'b': its red, green and blue look alike"));
  Eigen::Matrix3d reddish;
  reddish << 1.0, 0.9, 0.9, 0.0, 0.05, 0.0, 0.0, 0.0, 0.05;
  Eigen::Matrix3d bluish;
  bluish << 0.05, 0.0, 0.0, 0.0, 0.05, 0.0, 0.9, 0.9, 1.0;
  const std::vector<Eigen::Matrix3d> apart = {reddish, bluish};
  EXPECT_FALSE(common_gamut(apart, kLuminance, names));
}

TEST(PictureField, follows_smooth_data_and_fills_gaps_without_diverging) {
  std::vector<FieldSample> samples;
  std::vector<double> values;
  const auto truth = [](const Eigen::Vector2d& p) { return 0.5 * std::cos(0.01 * p.x()) + 1e-3 * p.y(); };
  for (double y = 5.0; y < 200.0; y += 10.0) {
    for (double x = 5.0; x < 320.0; x += 10.0) {
      if (x > 100.0 && x < 150.0) continue;
      samples.push_back({{x, y}, 1e-3});
      values.push_back(truth(samples.back().pixel));
    }
  }
  const FieldFit fit(320, 200, 16, 0.01, samples);
  ASSERT_TRUE(fit.is_solved());
  const PictureField field =
      fit.fit(Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(50, 50), Eigen::Vector2d(200, 100), Eigen::Vector2d(319, 199)})
    EXPECT_NEAR(field.at(p), truth(p), 2e-3) << p.transpose();
  EXPECT_NEAR(field.at({125.0, 100.0}), truth({125.0, 100.0}), 0.02);
}

TEST(ReadLight, averages_cells_and_leaves_out_clipped_ones) {
  structured_light::Decoded decoded;
  decoded.position_px = Image<float, 2>(80, 60);
  decoded.fate = Image<structured_light::PixelFate, 1>(80, 60, structured_light::PixelFate::kDecoded);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      decoded.position_px.at(x, y)[0] = static_cast<float>(x) * 4.0f + 2.0f;
      decoded.position_px.at(x, y)[1] = static_cast<float>(y) * 4.0f + 2.0f;
    }
  }
  const auto cells = camera_cells(decoded, 320, 240, 32);
  ASSERT_TRUE(cells);
  EXPECT_EQ(cells->cells_x, 10);
  Image<float, 3> photograph(80, 60, 0.25f);
  for (int y = 24; y < 32; ++y) photograph.at(40, y)[1] = 1.0f;
  const auto reading = read_light(*cells, photograph, {.kind = structured_light::PatternKind::kWhite}, 0.1);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->level, 1.0);
  EXPECT_FLOAT_EQ(reading->codes[12].code[0], 0.25f);
  EXPECT_FALSE(reading->codes[12].is_clipped[0]);
  EXPECT_TRUE(reading->codes[35].is_clipped[1]);
  EXPECT_FALSE(read_light(*cells, photograph, {.kind = structured_light::PatternKind::kBit}, 0.1));
  EXPECT_FALSE(read_light(*cells, photograph, {.kind = structured_light::PatternKind::kWhite}, 0.0));
  EXPECT_FALSE(read_light(*cells, Image<float, 3>(8, 6), {.kind = structured_light::PatternKind::kWhite}, 0.1));
  EXPECT_FALSE(camera_cells(decoded, 0, 240, 32));
}

}  // namespace
}  // namespace cyclorama::photometry
