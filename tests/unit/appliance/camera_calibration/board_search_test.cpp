// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/board_search.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "appliance/camera_calibration/lens_selection.h"
#include "tests/data_sets/board_photo.h"

namespace cyclorama::camera_calibration {
namespace {

calibration::BrownParameters true_lens() { return {800, 600, 690.0, 690.0, 407.0, 296.0, -0.12, 0.04, 0.0, 0.0, 0.0}; }

struct Pose {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
};

/// Returns a rotated pose with the board's centre at `at`.
Pose pose(const TagBoard& board, const Eigen::Vector3d& at, double yaw, double pitch, double roll) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector3d middle(0.5 * board.square_m * (board.columns - 2), 0.5 * board.square_m * (board.rows - 2),
                               0.0);
  return {R, at - R * middle};
}

class BoardSearch : public testing::Test {
 protected:
  BoardSearch() : lens_(*calibration::BrownLens::from(true_lens())), detector_(*make_board_detector()) {
    if (photographer_ == nullptr) photographer_ = std::make_unique<BoardPhotographer>(board_, lens_);
  }
  static void TearDownTestSuite() { photographer_.reset(); }

  /// Returns the RMS distance of the found corners from their true positions.
  double rms_px(const LensView& view, const Pose& at) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < view.board_m.size(); ++i) {
      const Eigen::Vector3d corner(view.board_m[i].x(), view.board_m[i].y(), 0.0);
      const auto pixel = lens_.pixel_of(at.R * corner + at.t);
      EXPECT_TRUE(pixel.has_value());
      if (pixel) sum += (view.camera_px[i] - *pixel).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(view.board_m.size()));
  }

  TagBoard board_;
  calibration::BrownLens lens_;
  static inline std::unique_ptr<BoardPhotographer> photographer_;  ///< Shared, since computing its rays takes seconds.
  tags::TagDetector detector_;
};

TEST_F(BoardSearch, finds_all_corners_to_a_tenth_of_a_pixel) {
  const Pose at = pose(board_, {0.0, 0.0, 0.33}, 0.3, -0.2, 0.1);
  const auto view = find_board(photographer_->photograph(at.R, at.t), {board_}, &detector_);
  ASSERT_TRUE(view) << view.error().message();
  EXPECT_EQ(static_cast<int>(view->board_m.size()), board_.corners());
  EXPECT_LE(rms_px(*view, at), 0.1);
}

TEST_F(BoardSearch, accepts_a_partly_visible_board) {
  const Pose at = pose(board_, {0.13, 0.1, 0.26}, -0.3, 0.2, 0.0);
  const auto view = find_board(photographer_->photograph(at.R, at.t), {board_}, &detector_);
  ASSERT_TRUE(view) << view.error().message();
  EXPECT_LT(static_cast<int>(view->board_m.size()), board_.corners());
  EXPECT_LE(rms_px(*view, at), 0.1);
}

TEST_F(BoardSearch, refuses_a_picture_without_a_board) {
  const auto view = find_board(GreyImage(800, 600), {board_}, &detector_);
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(view.error().message(), testing::HasSubstr("; bring it nearer"));
}

TEST_F(BoardSearch, gives_the_lens_from_photographs) {
  std::vector<LensView> views;
  const Eigen::Vector3d correspondences[] = {{0.0, 0.0, 0.34},  {-0.1, -0.07, 0.3}, {0.1, -0.07, 0.3},
                                             {-0.1, 0.08, 0.3}, {0.11, 0.08, 0.3},  {0.0, 0.02, 0.45},
                                             {0.05, 0.0, 0.3},  {-0.04, 0.03, 0.27}};
  int number = 0;
  for (const Eigen::Vector3d& position : correspondences) {
    ++number;
    const double turn = 0.5 * (number % 2 == 0 ? 1.0 : -1.0);
    const Pose at =
        pose(board_, position, number % 3 == 0 ? 0.0 : turn, number % 3 == 1 ? 0.0 : -0.9 * turn, 0.1 * number);
    auto view = find_board(photographer_->photograph(at.R, at.t), {board_}, &detector_);
    ASSERT_TRUE(view) << number << ": " << view.error().message();
    view->name = "photograph " + std::to_string(number);
    views.push_back(*std::move(view));
  }
  const auto choice = select_lens(views, 800, 600);
  ASSERT_TRUE(choice) << choice.error().message();
  const auto& values = choice->fit.lens.values;
  EXPECT_NEAR(values[calibration::MeasuredLens::kFocal], 690.0, 1.0);
  EXPECT_NEAR(values[calibration::MeasuredLens::kCentreU], 407.0, 1.5);
  EXPECT_NEAR(values[calibration::MeasuredLens::kCentreV], 296.0, 1.5);
  EXPECT_LE(choice->heldout_rms_px, 0.1);
}

}  // namespace
}  // namespace cyclorama::camera_calibration
