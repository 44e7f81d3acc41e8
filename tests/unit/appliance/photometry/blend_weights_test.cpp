// SPDX-License-Identifier: Apache-2.0
// Weights where many pictures meet, with maps that do not quite fit each other.
#include "appliance/photometry/blend_weights.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>

#include "tests/data_sets/even_light.h"

namespace cyclorama::photometry {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kWidth_px = 960;
constexpr int kHeight_px = 540;

/// Direction of a projector in degrees.
struct Aim {
  double pan = 0.0;
  double tilt = 0.0;
  double roll = 0.0;
};

calibration::MeasuredMap aimed(const Aim& aim, double field_deg) {
  calibration::MeasuredMap map = far_map(kWidth_px, kHeight_px, field_deg * kDegree, 0.0);
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(-aim.pan * kDegree, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(aim.tilt * kDegree, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(aim.roll * kDegree, Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d& d : map.directions) d = turn * d;
  return map;
}

Eigen::Vector3d direction_of(double azimuth_deg, double elevation_deg) {
  const double azimuth = azimuth_deg * kDegree;
  const double elevation = elevation_deg * kDegree;
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), -std::cos(azimuth) * std::cos(elevation)};
}

struct Wall {
  const char* name;
  double field_deg;
  std::vector<Aim> aims;
};
void PrintTo(const Wall& wall, std::ostream* out) { *out << wall.name; }

struct Maps {
  std::vector<PhotometricProjector> projectors;
  std::vector<InverseMap> inverses;
};
/// `off_px`: each map has an independent error, like maps that were measured one by one.
Maps maps_of(const Wall& wall, double off_px) {
  Maps maps;
  for (std::size_t p = 0; p < wall.aims.size(); ++p) {
    Aim aim = wall.aims[p];
    const double off_deg = off_px * wall.field_deg / kWidth_px;
    aim.pan += off_deg * std::cos(2.0 * static_cast<double>(p));
    aim.tilt += off_deg * std::sin(2.0 * static_cast<double>(p));
    maps.projectors.push_back({"one of some", aimed(aim, wall.field_deg)});
    maps.inverses.push_back(*InverseMap::make(maps.projectors.back().map));
  }
  return maps;
}

/// Beyond the rim of the lit area the corners of pictures touch in a point, where any weights must jump.
bool is_near_the_rim(const Maps& maps, double azimuth, double elevation, double by_deg) {
  for (const double across : {-by_deg, 0.0, by_deg}) {
    for (const double up : {-by_deg, 0.0, by_deg}) {
      const Eigen::Vector3d direction = direction_of(azimuth + across, elevation + up);
      if (std::ranges::none_of(maps.inverses, [&](const InverseMap& m) { return m.pixel_at(direction).has_value(); }))
        return true;
    }
  }
  return false;
}

class BlendWeightsOf : public testing::TestWithParam<Wall> {};

/// Measures what calibration_bench calls "weights off 1": each picture has the weights of its own map, and the wall
/// adds them up according to the truth.
TEST_P(BlendWeightsOf, add_up_to_one_although_maps_are_off_by_hundredths_of_a_pixel) {
  constexpr double kOff_px = 0.03;
  constexpr double kRim_deg = 0.4;  // About ten pixels.
  const Maps truth = maps_of(GetParam(), 0.0);
  const Maps measured = maps_of(GetParam(), kOff_px);
  const BlendWeights weights(measured.projectors, measured.inverses);
  double worst = 0.0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  int positions = 0;
  std::size_t max = 0;
  for (double azimuth = -70.0; azimuth <= 70.0; azimuth += 0.21) {
    for (double elevation = -35.0; elevation <= 35.0; elevation += 0.23) {
      const Eigen::Vector3d direction = direction_of(azimuth, elevation);
      double sum = 0.0;
      std::size_t pictures = 0;
      for (std::size_t p = 0; p < truth.inverses.size(); ++p) {
        const auto pixel = truth.inverses[p].pixel_at(direction);
        if (!pixel) continue;
        ++pictures;
        for (const auto& share : weights.at(*measured.projectors[p].map.direction_at(*pixel), p, *pixel)) {
          if (share.projector == p) sum += share.weight;
        }
      }
      max = std::max(max, pictures);
      if (pictures < 2) continue;
      ++positions;
      if (std::abs(sum - 1.0) <= worst || is_near_the_rim(truth, azimuth, elevation, kRim_deg)) continue;
      worst = std::abs(sum - 1.0);
      at = {azimuth, elevation};
    }
  }
  EXPECT_GT(positions, 500);
  EXPECT_GE(max, std::min<std::size_t>(GetParam().aims.size(), 2));
  EXPECT_LE(worst, 0.005) << "at azimuth, elevation " << at.transpose();
  RecordProperty("worst", std::to_string(worst));
}

const Wall kWalls[] = {
    // The projectors look down from above: upper sides cross in a wedge of some degrees, and two pictures end there.
    {"four in a row", 38.0, {{-43.5, -13.0, 0.0}, {-14.5, -13.0, 0.0}, {14.5, -13.0, 0.0}, {43.5, -13.0, 0.0}}},
    {"three over each other", 40.0, {{-13.0, -13.0, 0.0}, {0.0, -13.0, 0.0}, {13.0, -13.0, 0.0}}},
    {"four over each other", 44.0, {{-12.0, -13.0, 0.0}, {-4.0, -13.0, 1.0}, {4.0, -13.0, -1.0}, {12.0, -13.0, 0.5}}},
    {"four in a square", 40.0, {{-15.0, -9.0, 0.7}, {15.0, -8.5, -0.5}, {-15.5, 9.0, 0.4}, {15.2, 8.7, 0.9}}},
    {"level, upper sides all but the same", 38.0, {{-14.0, 0.0, 0.0}, {14.0, 0.02, 0.05}}},
    {"one picture in another", 40.0, {{0.0, 0.0, 0.0}, {1.0, 0.5, 35.0}}},
};
INSTANTIATE_TEST_SUITE_P(walls, BlendWeightsOf, testing::ValuesIn(kWalls));

TEST(BlendWeights, fade_only_towards_sides_inside_another_picture) {
  const Maps maps = maps_of({"two", 40.0, {{-15.0, 0.0, 0.0}, {15.0, 0.0, 0.0}}}, 0.0);
  const BlendWeights weights(maps.projectors, maps.inverses);
  const auto left_at = [&](const Eigen::Vector2d& pixel) {
    for (const auto& share : weights.at(*maps.projectors[0].map.direction_at(pixel), 0, pixel)) {
      if (share.projector == 0) return share.weight;
    }
    return -1.0;
  };
  EXPECT_NEAR(left_at({kWidth_px - 1e-6, 0.5 * kHeight_px}), 0.0, 1e-9);
  // The right picture begins here, so the left one still has the full weight.
  EXPECT_EQ(left_at({0.3 * kWidth_px, 0.5 * kHeight_px}), 1.0);
  // The rim of the lit area has no influence: in the middle of the overlap the weight is a half, even at its top.
  const auto pixel = maps.inverses[0].pixel_at(-Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(left_at(*pixel), 0.5, 0.01);
  const auto above = maps.inverses[0].pixel_at(Eigen::Vector3d(0.0, 0.19, -1.0).normalized());
  ASSERT_TRUE(above);
  EXPECT_LT(above->y(), 0.1 * kHeight_px);
  EXPECT_NEAR(left_at(*above), 0.5, 0.01);
}

TEST(BlendWeights, are_equal_for_projectors_in_one_position) {
  const Maps maps = maps_of({"two in one", 40.0, {{0.0, 0.0, 0.0}, {0.01, -0.01, 0.02}}}, 0.0);
  const BlendWeights weights(maps.projectors, maps.inverses);
  for (const double x : {-0.2, 0.0, 0.1}) {
    for (const double y : {-0.1, 0.1}) {
      const auto shares = weights.at(Eigen::Vector3d(x, y, -1.0).normalized());
      ASSERT_EQ(shares.size(), 2u);
      EXPECT_NEAR(shares[0].weight, 0.5, 1e-6);
    }
  }
}

}  // namespace
}  // namespace cyclorama::photometry
