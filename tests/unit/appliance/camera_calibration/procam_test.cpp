// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <string>

#include "appliance/calibration/brown_lens.h"
#include "appliance/camera_calibration/procam_selection.h"
#include "appliance/camera_calibration/procam_start.h"

namespace cyclorama::camera_calibration {
namespace {

constexpr ImageSize kCameraSize{1280, 1024};
constexpr ImageSize kProjectorSize{1024, 768};

calibration::BrownParameters camera_lens() {
  return {.width_px = 1280,
          .height_px = 1024,
          .focal_u_px = 1800.0,
          .focal_v_px = 1800.0,
          .centre_u_px = 650.0,
          .centre_v_px = 500.0,
          .k1 = -0.2};
}
/// A projector's lens with lens shift: its principal point lies below its picture.
calibration::BrownParameters projector_lens() {
  return {.width_px = 1024,
          .height_px = 768,
          .focal_u_px = 1500.0,
          .focal_v_px = 1500.0,
          .centre_u_px = 505.0,
          .centre_v_px = 830.0,
          .k1 = -0.1};
}

struct Rig {
  calibration::BrownParameters camera = camera_lens();
  calibration::BrownParameters projector = projector_lens();
  Eigen::Matrix3d R = Eigen::AngleAxisd(0.15, Eigen::Vector3d(0.2, 1.0, 0.1).normalized()).toRotationMatrix();
  Eigen::Vector3d t{0.3, 0.5, -0.1};
};

/// Returns views of boards tilted about different axes; `tilt_rad` 0: all of them face the camera.
std::vector<BoardView> views_of(const Rig& rig, int count, double tilt_rad, double noise_px, unsigned seed = 5,
                                const BoardShape& shape = {}) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_px);
  const auto camera = calibration::BrownLens::from(rig.camera);
  const auto projector = calibration::BrownLens::from(rig.projector);
  CHECK(camera.has_value() && projector.has_value());
  std::vector<BoardView> views;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.4 * i;
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)).toRotationMatrix();
    const Eigen::Vector3d origin(-0.3 + 0.03 * i, -0.22 - 0.02 * i, 2.0 + 0.15 * (i % 3));
    BoardView view;
    for (const Eigen::Vector2d& corner : chessboard_corners(9, 7, 0.07)) {
      const double height = shape.bend_xx * corner.x() * corner.x() + shape.bend_xy * corner.x() * corner.y() +
                            shape.bend_yy * corner.y() * corner.y();
      const Eigen::Vector3d centred(corner.x() - 0.28, corner.y() * (1.0 + shape.stretch) - 0.21, height);
      const Eigen::Vector3d in_camera = turned * centred + Eigen::Vector3d(0.28, 0.21, 0.0) + origin;
      const auto seen = camera->pixel_of(in_camera);
      const auto lit = projector->pixel_of(rig.R * in_camera + rig.t);
      CHECK(seen.has_value() && lit.has_value());
      view.board_m.push_back(corner);
      view.camera_px.push_back(*seen + Eigen::Vector2d(noise(random), noise(random)));
      view.projector_px.push_back(*lit + Eigen::Vector2d(noise(random), noise(random)));
    }
    views.push_back(view);
  }
  return views;
}

TEST(Homography, recovers_the_mapping_of_a_plane) {
  Eigen::Matrix3d h;
  h << 1.2, 0.1, 5.0, -0.2, 0.9, 7.0, 1e-3, 2e-3, 1.0;
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const Eigen::Vector2d& p : chessboard_corners(4, 3, 10.0)) {
    from.push_back(p);
    to.push_back((h * p.homogeneous()).hnormalized());
  }
  const auto found = homography(from, to);
  ASSERT_TRUE(found);
  for (std::size_t i = 0; i < from.size(); ++i)
    EXPECT_LT(((*found * from[i].homogeneous()).hnormalized() - to[i]).norm(), 1e-8);
  EXPECT_FALSE(homography({from[0], from[1], from[2]}, {to[0], to[1], to[2]}));
  for (Eigen::Vector2d& p : from) p.y() = 0.0;
  EXPECT_FALSE(homography(from, to)) << "all on a line";
}

TEST(Procam, is_exact_for_exact_views) {
  const Rig rig;
  const auto found = solve_procam(views_of(rig, 4, 0.5, 0.0), {kCameraSize, kProjectorSize});
  ASSERT_TRUE(found.has_value()) << found.error().message();
  EXPECT_LT(found->stereo_rms_px, 1e-6);
  EXPECT_NEAR(found->camera.focal_u_px, rig.camera.focal_u_px, 1e-2);
  EXPECT_NEAR(found->projector.centre_v_px, rig.projector.centre_v_px, 1e-2);
  EXPECT_NEAR(found->projector.k1, rig.projector.k1, 1e-4);
  EXPECT_LT((found->T_projector_camera.translation() - rig.t).norm(), 1e-4);
  EXPECT_LT((found->T_projector_camera.rotation().toRotationMatrix() - rig.R).norm(), 1e-4);
  EXPECT_EQ(found->rank, found->unknowns);
  EXPECT_EQ(found->unknowns, 2 * 4 + 6 + 4 * 6);
}

TEST(Procam, has_a_consistent_covariance) {
  const Rig rig;
  double squares = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto found = solve_procam(views_of(rig, 4, 0.5, 0.2, seed), {kCameraSize, kProjectorSize});
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->stereo_rms_px, 0.2 * std::sqrt(2.0), 0.04);
    const calibration::BrownBlock camera = calibration::to_block(found->camera);
    const calibration::BrownBlock projector = calibration::to_block(found->projector);
    for (const int i : {calibration::kFocalU, calibration::kCentreU, calibration::kCentreV, calibration::kK1}) {
      const auto at = static_cast<std::size_t>(i);
      squares += std::pow((camera.at(at) - calibration::to_block(rig.camera).at(at)) / found->camera_sigma.at(at), 2);
      squares +=
          std::pow((projector.at(at) - calibration::to_block(rig.projector).at(at)) / found->projector_sigma.at(at), 2);
      count += 2;
    }
  }
  // 96 squares of variance 1, correlated in groups of four.
  EXPECT_GT(squares / count, 0.5);
  EXPECT_LT(squares / count, 1.8);
}

TEST(Procam, converges_from_several_starting_points) {
  const auto found = solve_procam(views_of(Rig{}, 4, 0.5, 0.2), {kCameraSize, kProjectorSize});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->starts_agreeing, kMaxStarts);
}

TEST(Procam, refuses_views_that_do_not_determine_it_and_names_what_to_add) {
  for (const auto& views : {views_of(Rig{}, 3, 0.0, 0.0), views_of(Rig{}, 1, 0.5, 0.1)}) {
    const auto found = solve_procam(
        views, {kCameraSize, kProjectorSize, calibration::LensModel::kFull, calibration::LensModel::kFull});
    ASSERT_FALSE(found.has_value());
    EXPECT_EQ(found.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(found.error().message(), testing::HasSubstr("add one"));
  }
}

TEST(Procam, refuses_nan) {
  const ProcamChoice choice{kCameraSize, kProjectorSize};
  EXPECT_FALSE(solve_procam({}, choice).has_value());
  auto views = views_of(Rig{}, 3, 0.5, 0.1);
  views[1].camera_px[7].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_procam(views, choice).has_value());
  views = views_of(Rig{}, 3, 0.5, 0.1);
  views[0].projector_px.pop_back();
  EXPECT_FALSE(solve_procam(views, choice).has_value());
  views = views_of(Rig{}, 3, 0.5, 0.1);
  for (Eigen::Vector2d& corner : views[2].board_m) corner.setZero();
  EXPECT_FALSE(solve_procam(views, choice).has_value());
}

TEST(Procam, predicts_a_view_that_was_left_out) {
  const Rig rig;
  auto views = views_of(rig, 5, 0.5, 0.2);
  const BoardView left_out = views.back();
  views.pop_back();
  const auto found = solve_procam(views, {kCameraSize, kProjectorSize});
  ASSERT_TRUE(found.has_value());
  const auto prediction = held_out(left_out, *found);
  ASSERT_TRUE(prediction.has_value());
  EXPECT_LT(prediction->stereo_rms_px, 0.4);
  EXPECT_GE(prediction->projector_rms_px, prediction->camera_rms_px * 0.8);
}

std::string table_of(const ProcamSelection& selection) {
  std::string table;
  for (const ProcamCandidate& model : selection.models) {
    table += std::string(calibration::name_of(model.camera)) + " | " +
             std::string(calibration::name_of(model.projector)) + " | " +
             (model.board == BoardModel::kBent ? "bent | " : "flat | ") + std::to_string(model.training_rms_px) +
             " | " + std::to_string(model.heldout_rms_px) + "\n";
  }
  return table;
}

TEST(ProcamSelection, takes_the_smallest_model_that_predicts_well) {
  Rig rig;
  rig.camera.k1 = -0.6;
  rig.projector.k1 = 0.0;
  const auto selection = select_procam_model(views_of(rig, 5, 0.5, 0.1), kCameraSize, kProjectorSize);
  ASSERT_TRUE(selection.has_value()) << selection.error().message();
  const ProcamCandidate& chosen = selection->models[selection->chosen];
  EXPECT_EQ(chosen.camera, calibration::LensModel::kRadial1) << table_of(*selection);
  EXPECT_EQ(chosen.projector, calibration::LensModel::kPinhole) << table_of(*selection);
  EXPECT_EQ(chosen.board, BoardModel::kFlat) << table_of(*selection);
  for (const ProcamCandidate& model : selection->models) {
    // Neither a model with more parameters that predicts better was passed over, nor one with fewer that predicts as
    // well.
    if (model.freedom > chosen.freedom) {
      EXPECT_GE(model.heldout_rms_px * 1.000001, chosen.heldout_rms_px * (1.0 - calibration::kMinModelGain));
    }
    if (model.freedom < chosen.freedom) {
      EXPECT_GT(model.heldout_rms_px, chosen.heldout_rms_px);
    }
  }
}

TEST(ProcamSelection, detects_a_bent_board) {
  // On a bent board each corner is displaced by its height.
  const BoardShape shape{.stretch = 0.002, .bend_xx = 0.015, .bend_yy = -0.02};
  const auto selection = select_procam_model(views_of(Rig{}, 5, 0.5, 0.1, 5, shape), kCameraSize, kProjectorSize);
  ASSERT_TRUE(selection.has_value()) << selection.error().message();
  EXPECT_EQ(selection->models[selection->chosen].board, BoardModel::kBent) << table_of(*selection);
  EXPECT_NEAR(selection->calibration.board.bend_xx, shape.bend_xx, 0.003);
  EXPECT_NEAR(selection->calibration.board.bend_yy, shape.bend_yy, 0.003);
}

TEST(ProcamSelection, refuses_too_few_views_to_leave_one_out) {
  const auto selection = select_procam_model(views_of(Rig{}, 2, 0.5, 0.1), kCameraSize, kProjectorSize);
  ASSERT_FALSE(selection.has_value());
  EXPECT_EQ(selection.error().code(), ErrorCode::kBadData);
}

}  // namespace
}  // namespace cyclorama::camera_calibration
