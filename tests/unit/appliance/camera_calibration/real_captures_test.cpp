// SPDX-License-Identifier: Apache-2.0
/// Tests on real photographs. Only the first capture, to be quick; `./bench.sh calibration-real` measures all three.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "appliance/camera_calibration/chessboard.h"
#include "appliance/camera_calibration/procam_selection.h"
#include "appliance/camera_calibration/projector_corners.h"
#include "appliance/structured_light/decode_quality.h"
#include "tests/bench/calibration/procam_truth.h"
#include "tests/data_sets/real_captures.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama::camera_calibration {
namespace {

/// Converts OpenCV's pixels of expected.json, where the first pixel's centre is (0, 0), in the camera and on the
/// projector.
std::vector<Eigen::Vector2d> points_of(const nlohmann::json& list) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& point : list) points.emplace_back(point.at(0).get<double>() + 0.5, point.at(1).get<double>() + 0.5);
  return points;
}

nlohmann::json expected_of(const std::filesystem::path& folder) {
  std::ifstream file(folder / "expected.json");
  return nlohmann::json::parse(file);
}

std::vector<BoardView> reference_views(const std::filesystem::path& folder) {
  std::vector<BoardView> views;
  const nlohmann::json expected = expected_of(folder);
  for (const auto& capture : expected.at("captures")) {
    views.push_back({chessboard_corners(9, 7, 0.075), points_of(capture.at("camera_corners")),
                     points_of(capture.at("projector_corners"))});
  }
  return views;
}

Result<ProcamCalibration> reference_calibration(const std::vector<BoardView>& views) {
  return solve_procam(views, {{1280, 1024},
                              {1024, 768},
                              calibration::LensModel::kRadial1,
                              calibration::LensModel::kRadial1,
                              BoardModel::kBent});
}

TEST(RealCapture, is_decoded_precisely_and_without_gross_errors) {
  CYCLORAMA_SHARED_DATA(folder, "graycode");
  const auto decoder = real_decoder(folder, 0);
  ASSERT_TRUE(decoder.has_value()) << decoder.error().message();
  const auto decoded = decoder->finish();
  ASSERT_TRUE(decoded.has_value()) << decoded.error().message();
  const structured_light::DecodeQuality quality = structured_light::quality_of(*decoded, 20.0 / 255.0);
  EXPECT_GE(quality.coverage, 0.75);
  EXPECT_LE(quality.residual_median_px, 0.20);
  const auto views = reference_views(folder);
  const auto calibration = reference_calibration(views);
  ASSERT_TRUE(calibration.has_value()) << calibration.error().message();
  TruthScore score;
  score_against(*decoded, views[0], *calibration, 0, 3, &score);
  EXPECT_GT(score.judged, 50000);
  EXPECT_LE(score.gross(), 0.001);

  const auto white = real_photo(folder, 0, kRealWhite);
  ASSERT_TRUE(white.has_value());
  const auto corners = find_chessboard(*white, 9, 7);
  ASSERT_TRUE(corners.has_value()) << corners.error().message();
  const BoardView& expected = views[0];
  ASSERT_EQ(corners->size(), expected.camera_px.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < expected.camera_px.size(); ++i) {
    const Eigen::Vector2d& camera = expected.camera_px[i];
    const auto nearest = std::min_element(corners->begin(), corners->end(), [&](const auto& a, const auto& b) {
      return (a - camera).norm() < (b - camera).norm();
    });
    EXPECT_LT((*nearest - camera).norm(), 0.7) << i;
    const auto position = projector_pixel_at(*decoded, camera, 24.0);
    ASSERT_TRUE(position) << i;
    squares += (*position - expected.projector_px[i]).squaredNorm() / static_cast<double>(corners->size());
  }
  // Two methods on the same photographs; the other one uses whole pixels.
  EXPECT_LT(std::sqrt(squares), 0.35);
}

TEST(RealCapture, calibrates_camera_and_projector_from_the_references_corners) {
  CYCLORAMA_SHARED_DATA(folder, "graycode");
  const auto found = reference_calibration(reference_views(folder));
  ASSERT_TRUE(found.has_value()) << found.error().message();
  EXPECT_LE(found->stereo_rms_px, 0.28);
  EXPECT_NEAR(found->camera.focal_u_px, 3444.0, 150.0);
  EXPECT_EQ(found->starts_agreeing, kMaxStarts);
}

TEST(Chessboard, is_not_found_where_there_is_none) {
  const auto nothing = find_chessboard(GreyImage(320, 240, 128), 9, 7);
  ASSERT_FALSE(nothing.has_value());
  EXPECT_EQ(nothing.error().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(find_chessboard(GreyImage(), 9, 7).has_value());
  EXPECT_FALSE(find_chessboard(GreyImage(320, 240), 2, 7).has_value());
}

}  // namespace
}  // namespace cyclorama::camera_calibration
