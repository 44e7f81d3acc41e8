// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/lens_selection.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "common/board/tag_board.h"

namespace cyclorama::camera_calibration {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 960;

calibration::BrownParameters true_lens() {
  return {kWidth, kHeight, 1105.0, 1105.0, 652.0, 471.0, -0.11, 0.05, 0.0, 0.0, 0.0};
}

struct Shown {
  double tilt_rad = 0.5;  ///< Maximum tilt about any horizontal axis.
  double aside = 0.45;    ///< Maximum offset as a fraction of the picture's half width and height.
  double near_m = 0.25;
  double far_m = 0.5;
  double noise_px = 0.05;
};

/// Returns views of a board that somebody holds in front of the camera.
std::vector<LensView> shown(const calibration::BrownParameters& truth, int count, unsigned seed,
                            const Shown& how = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, how.noise_px);
  const auto lens = calibration::BrownLens::from(truth);
  CHECK(lens.has_value());
  const TagBoard board;
  const Eigen::Vector3d middle(0.5 * board.square_m * (board.columns - 2), 0.5 * board.square_m * (board.rows - 2),
                               0.0);
  std::vector<LensView> views;
  while (static_cast<int>(views.size()) < count) {
    const double angle = 3.14159 * unit(random);
    const Eigen::Matrix3d R =
        (Eigen::AngleAxisd(how.tilt_rad * unit(random), Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)) *
         Eigen::AngleAxisd(0.3 * unit(random), Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    const double far = how.near_m + (how.far_m - how.near_m) * 0.5 * (1.0 + unit(random));
    const Eigen::Vector3d at(far * how.aside * unit(random) * kWidth / truth.focal_u_px,
                             far * how.aside * unit(random) * kHeight / truth.focal_u_px, far);
    LensView view;
    view.name = "view " + std::to_string(views.size());
    for (int i = 0; i < board.corners(); ++i) {
      const Eigen::Vector3d corner(board.corner_m(i).x(), board.corner_m(i).y(), 0.0);
      const auto pixel = lens->pixel_of(R * (corner - middle) + at);
      if (!pixel || !(pixel->x() > 4 && pixel->y() > 4 && pixel->x() < kWidth - 4 && pixel->y() < kHeight - 4))
        continue;
      view.board_m.push_back(board.corner_m(i));
      view.camera_px.push_back(*pixel + Eigen::Vector2d(noise(random), noise(random)));
    }
    if (view.board_m.size() >= 12) views.push_back(view);
  }
  return views;
}

/// Returns the largest distance over the picture between the images of a direction in two lenses, after the best
/// rotation: the forward direction of a lens is a gauge that poses compensate for.
double apart_px(const calibration::MeasuredLens& found, const calibration::BrownParameters& truth) {
  const auto a = calibration::BrownLens::from(truth);
  const auto b = found.brown();
  CHECK(a.has_value() && b.has_value());
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
  Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
  for (int y = 0; y <= 8; ++y) {
    for (int x = 0; x <= 8; ++x) {
      const Eigen::Vector2d pixel(x * kWidth / 8.0, y * kHeight / 8.0);
      const auto one = calibration::direction_through(*a, pixel);
      const auto two = calibration::direction_through(*b, pixel);
      CHECK(one && two);
      pairs.emplace_back(one->normalized(), two->normalized());
      together += pairs.back().second * pairs.back().first.transpose();
    }
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(together, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixV() * svd.matrixU().transpose();
  double worst = 0.0;
  for (const auto& [one, two] : pairs) worst = std::max(worst, (one - turn * two).norm() * truth.focal_u_px);
  return worst;
}

TEST(LensSelection, recovers_a_lens_within_its_stated_uncertainty) {
  int within = 0;
  constexpr int kSeeds = 4;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto choice = select_lens(shown(true_lens(), 14, seed), kWidth, kHeight);
    ASSERT_TRUE(choice) << choice.error().message();
    const calibration::MeasuredLens& lens = choice->fit.lens;
    const double sigma =
        std::sqrt(lens.covariance(calibration::MeasuredLens::kFocal, calibration::MeasuredLens::kFocal));
    EXPECT_LE(sigma, 2.0);
    within += std::abs(lens.values[calibration::MeasuredLens::kFocal] - 1105.0) <= 3.0 * sigma ? 1 : 0;
    EXPECT_LE(apart_px(lens, true_lens()), 0.5) << calibration::name_of(choice->model);
    EXPECT_NEAR(choice->heldout_rms_px, 0.05, 0.015);
    EXPECT_GE(calibration::freedom_of(choice->model), calibration::freedom_of(calibration::LensModel::kRadial1));
  }
  EXPECT_GE(within, kSeeds - 1);
}

TEST(LensSelection, takes_no_more_parameters_than_improve_the_prediction) {
  calibration::BrownParameters pinhole = true_lens();
  pinhole.k1 = pinhole.k2 = 0.0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto choice = select_lens(shown(pinhole, 14, seed), kWidth, kHeight);
    ASSERT_TRUE(choice) << choice.error().message();
    EXPECT_EQ(choice->model, calibration::LensModel::kPinhole);
  }
}

TEST(LensSelection, is_robust_against_wrong_corners) {
  std::vector<LensView> views = shown(true_lens(), 14, 3);
  for (std::size_t i = 0; i < views.size(); ++i) views[i].camera_px[i % 12] += Eigen::Vector2d(15.0, -9.0);
  const auto choice = select_lens(views, kWidth, kHeight);
  ASSERT_TRUE(choice) << choice.error().message();
  EXPECT_LE(apart_px(choice->fit.lens, true_lens()), 0.6);
}

TEST(LensSelection, one_stray_picture_is_left_out_and_named) {
  calibration::BrownParameters zoomed = true_lens();
  zoomed.focal_u_px = zoomed.focal_v_px = 900.0;
  calibration::BrownParameters shifted = true_lens();
  shifted.centre_u_px += 40.0;
  Shown blurred;
  blurred.noise_px = 3.0;
  const LensView strays[] = {shown(zoomed, 1, 9).front(), shown(shifted, 1, 9).front(),
                             shown(true_lens(), 1, 9, blurred).front()};
  for (unsigned number = 0; number < std::size(strays); ++number) {
    std::vector<LensView> views = shown(true_lens(), 12, 5);
    LensView stray = strays[number];
    stray.name = "stray";
    views.insert(views.begin() + 4, stray);
    const auto choice = select_lens(views, kWidth, kHeight);
    ASSERT_TRUE(choice) << number << ": " << choice.error().message();
    EXPECT_LE(apart_px(choice->fit.lens, true_lens()), 0.6) << number;
    EXPECT_THAT(choice->used, testing::Not(testing::Contains("stray"))) << number;
    EXPECT_THAT(choice->remarks, testing::Contains(testing::HasSubstr("'stray' does not fit the other pictures")));
  }
  const auto clean = select_lens(shown(true_lens(), 12, 5), kWidth, kHeight);
  ASSERT_TRUE(clean) << clean.error().message();
  EXPECT_EQ(clean->used.size(), 12u);
}

TEST(LensSelection, refuses_too_few_and_identical_pictures) {
  const std::vector<LensView> views = shown(true_lens(), 4, 1);
  const auto few = select_lens(views, kWidth, kHeight);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(few.error().message(), testing::HasSubstr("4 of 4 pictures"));
  EXPECT_THAT(few.error().message(), testing::HasSubstr("; move it"));
  const auto same = select_lens(std::vector<LensView>(20, views.front()), kWidth, kHeight);
  ASSERT_FALSE(same);
  EXPECT_THAT(same.error().message(), testing::HasSubstr("1 of 20 pictures"));
}

TEST(LensSelection, refuses_boards_that_all_face_the_camera) {
  Shown flat;
  flat.tilt_rad = 0.0;
  const auto choice = select_lens(shown(true_lens(), 14, 2, flat), kWidth, kHeight);
  ASSERT_FALSE(choice);
  EXPECT_EQ(choice.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(choice.error().message(), testing::HasSubstr("turned by 20 to 45 degrees"));
}

TEST(LensSelection, reports_the_part_of_the_picture_that_is_unknown) {
  Shown middle;
  middle.aside = 0.12;
  middle.near_m = 0.7;
  middle.far_m = 1.3;
  middle.noise_px = 0.5;
  const auto choice = select_lens(shown(true_lens(), 10, 5, middle), kWidth, kHeight);
  const std::string words =
      choice ? (choice->remarks.empty() ? "" : choice->remarks.front()) : choice.error().message();
  EXPECT_THAT(words, testing::HasSubstr("; add pictures with the board"));
}

TEST(LensSelection, refuses_nan) {
  std::vector<LensView> views = shown(true_lens(), 8, 1);
  views[3].camera_px[2].x() = std::nan("");
  const auto choice = select_lens(views, kWidth, kHeight);
  ASSERT_FALSE(choice);
  EXPECT_EQ(choice.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(choice.error().message(), testing::HasSubstr("view 3"));
}

}  // namespace
}  // namespace cyclorama::camera_calibration
