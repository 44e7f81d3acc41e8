// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/lens_solve.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "appliance/camera_calibration/procam_start.h"
#include "appliance/solve/uncertainty.h"

namespace cyclorama::camera_calibration {
namespace {

using PoseBlock = std::array<double, 6>;  // Pose of the board in the camera's frame: angle-axis, then translation.

constexpr double kUsual_px = 0.1;  // Assumed sigma of a corner: the unit of residuals.
constexpr double kLoss_sigmas = 5.0;
constexpr std::size_t kMinViewCorners = 8;

struct CornerCost {
  Eigen::Vector2d board_m;
  Eigen::Vector2d camera_px;
  template <typename T>
  bool operator()(const T* lens, const T* pose, T* ret_residuals) const {
    const T corner[3] = {pose[0] * 0.0 + board_m.x(), pose[0] * 0.0 + board_m.y(), pose[0] * 0.0};
    T point[3];
    ceres::AngleAxisRotatePoint(pose, corner, point);
    for (int i = 0; i < 3; ++i) point[i] += pose[3 + i];
    if (!(point[2] > 1e-6)) return false;
    T pixel[2];
    calibration::project_through_lens(lens, point, pixel);
    for (int i = 0; i < 2; ++i) ret_residuals[i] = (pixel[i] - camera_px[i]) / kUsual_px;
    return true;
  }
};

void add_view(const LensView& view, std::size_t first, std::size_t step, double* lens, double* pose,
              ceres::LossFunction* loss, ceres::Problem* problem) {
  for (std::size_t i = first; i < view.board_m.size(); i += step) {
    problem->AddResidualBlock(new ceres::AutoDiffCostFunction<CornerCost, 2, calibration::MeasuredLens::kParameters, 6>(
                                  new CornerCost{view.board_m[i], view.camera_px[i]}),
                              loss, lens, pose);
  }
}

PoseBlock block_of(const StartPose& pose) {
  PoseBlock block{};
  ceres::RotationMatrixToAngleAxis(pose.R.data(), block.data());  // Column-major, as in Eigen.
  std::copy_n(pose.t.data(), 3, block.begin() + 3);
  return block;
}

bool minimise(ceres::Problem* problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  return summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
}

/// Returns the RMS per axis in pixels, without the largest 5 %, of (u, v) residual pairs given in units of kUsual_px.
double trimmed_rms_px(const std::vector<double>& residuals) {
  std::vector<double> squares;
  for (std::size_t i = 0; i + 1 < residuals.size(); i += 2) {
    squares.push_back(0.5 * (residuals[i] * residuals[i] + residuals[i + 1] * residuals[i + 1]));
  }
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return kUsual_px * std::sqrt(sum / std::max<double>(1.0, static_cast<double>(squares.size())));
}

std::vector<double> residuals_of(ceres::Problem* problem) {
  std::vector<double> residuals;
  ceres::Problem::EvaluateOptions plain;
  plain.apply_loss_function = false;
  problem->Evaluate(plain, nullptr, &residuals, nullptr, nullptr);
  return residuals;
}

Result<std::vector<Eigen::Matrix3d>> homographies_of(const std::vector<LensView>& views) {
  if (views.empty()) return Error(ErrorCode::kInvalidArgument, "no picture shows the board; take some that do");
  std::vector<Eigen::Matrix3d> homographies;
  for (const LensView& view : views) {
    const auto is_finite = [](const Eigen::Vector2d& p) { return p.allFinite() && p.norm() < 1e9; };
    if (view.board_m.size() < kMinViewCorners || view.board_m.size() != view.camera_px.size() ||
        !std::all_of(view.board_m.begin(), view.board_m.end(), is_finite) ||
        !std::all_of(view.camera_px.begin(), view.camera_px.end(), is_finite)) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{}: fewer than {} corners, or numbers that are none; take it again", view.name,
                               kMinViewCorners));
    }
    const auto h = homography(view.board_m, view.camera_px);
    if (!h) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("{}: the corners lie on a line; show more of the board", view.name));
    }
    homographies.push_back(*h);
  }
  return homographies;
}

Error undetermined() {
  return {ErrorCode::kBadData,
          "these pictures do not determine the lens; add some with the board turned by 20 to 45 degrees about its "
          "upright and about its level axis, and some nearer"};
}

}  // namespace

Result<LensFit> solve_lens(const std::vector<LensView>& views, int width_px, int height_px,
                           calibration::LensModel model, std::optional<double> focal_px) {
  TRY_ASSIGN(const std::vector<Eigen::Matrix3d> homographies, homographies_of(views));
  const Eigen::Vector2d centre(0.5 * width_px, 0.5 * height_px);
  const double guess = focal_px ? *focal_px : focal_from(homographies, centre).value_or(std::max(width_px, height_px));
  const std::vector<double> factors = focal_px ? std::vector<double>{1.0} : std::vector<double>{1.0, 0.6, 1.7};
  const std::vector<int> held = calibration::held_parameters(model);
  std::optional<LensFit> best;
  double best_cost = 0.0;
  // Several starts, since there may be a local minimum at a wrong focal length.
  for (const double factor : factors) {
    LensFit fit;
    fit.lens = calibration::MeasuredLens::from_focal(width_px, height_px, factor * guess);
    const calibration::MeasuredLens::Covariance sheet = fit.lens.covariance;
    double* lens = fit.lens.values.data();
    std::vector<PoseBlock> poses;
    for (const Eigen::Matrix3d& h : homographies) poses.push_back(block_of(board_pose(h, factor * guess, centre)));
    ceres::Problem::Options owned;
    owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::CauchyLoss loss(kLoss_sigmas);
    ceres::Problem problem(owned);
    for (std::size_t i = 0; i < views.size(); ++i) {
      add_view(views[i], 0, 1, lens, poses[i].data(), nullptr, &problem);
    }
    // Fits first without distortion and with a fixed principal point, to converge from distant starts, then robustly
    // with all free parameters.
    std::vector<int> first = calibration::held_parameters(calibration::LensModel::kPinhole);
    first.insert(first.end(), {calibration::MeasuredLens::kCentreU, calibration::MeasuredLens::kCentreV});
    problem.SetManifold(lens, new ceres::SubsetManifold(calibration::MeasuredLens::kParameters, first));
    if (!minimise(&problem)) continue;
    ceres::Problem whole(owned);
    for (std::size_t i = 0; i < views.size(); ++i) add_view(views[i], 0, 1, lens, poses[i].data(), &loss, &whole);
    if (!held.empty()) whole.SetManifold(lens, new ceres::SubsetManifold(calibration::MeasuredLens::kParameters, held));
    if (!minimise(&whole) || !(fit.lens.values[calibration::MeasuredLens::kFocal] > 1.0)) continue;
    double cost = 0.0;
    whole.Evaluate({}, &cost, nullptr, nullptr, nullptr);
    if (best && !(cost < best_cost * (1.0 - 1e-9))) continue;
    fit.rms_px = trimmed_rms_px(residuals_of(&whole));
    std::vector<double*> blocks{lens};
    for (PoseBlock& pose : poses) blocks.push_back(pose.data());
    std::vector<int> free;
    std::vector<double> scale;
    for (int i = 0; i < calibration::MeasuredLens::kParameters; ++i) {
      if (std::find(held.begin(), held.end(), i) != held.end()) continue;
      free.push_back(i);
      // For focal length and centre the scale is the sigma of a data sheet; for coefficients it is wide.
      scale.push_back(i < calibration::MeasuredLens::kK1   ? std::sqrt(sheet(i, i))
                      : i < calibration::MeasuredLens::kP1 ? 1.0
                                                           : 0.1);
    }
    std::vector<ceres::ResidualBlockId> all;
    whole.GetResidualBlocks(&all);
    fit.freedom = static_cast<int>(free.size());
    const solve::Uncertainty uncertainty = solve::uncertainty_of(&whole, blocks, fit.freedom, 6, scale, all);
    fit.rank = uncertainty.rank;
    const double variance = std::max(1e-6, fit.rms_px * fit.rms_px / (kUsual_px * kUsual_px));
    fit.lens.covariance.setZero();
    for (std::size_t i = 0; i < free.size(); ++i) {
      for (std::size_t j = 0; j < free.size(); ++j) {
        fit.lens.covariance(free[i], free[j]) =
            variance * uncertainty.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
    best_cost = cost;
    best = fit;
  }
  if (!best || best->rank < best->freedom || !best->lens.covariance.allFinite()) return undetermined();
  return *std::move(best);
}

Result<double> prediction_error_px(const LensView& view, const calibration::MeasuredLens& lens) {
  TRY_ASSIGN(const std::vector<Eigen::Matrix3d> homographies, homographies_of({view}));
  calibration::MeasuredLens known = lens;
  const Eigen::Vector2d centre(lens.values[calibration::MeasuredLens::kCentreU],
                               lens.values[calibration::MeasuredLens::kCentreV]);
  PoseBlock pose = block_of(board_pose(homographies.front(), lens.values[calibration::MeasuredLens::kFocal], centre));
  ceres::Problem::Options owned;
  owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(kLoss_sigmas);
  ceres::Problem placing(owned);
  add_view(view, 0, 2, known.values.data(), pose.data(), &loss, &placing);
  placing.SetParameterBlockConstant(known.values.data());
  if (!minimise(&placing)) return undetermined();
  ceres::Problem predicting(owned);
  add_view(view, 1, 2, known.values.data(), pose.data(), nullptr, &predicting);
  return trimmed_rms_px(residuals_of(&predicting));
}

}  // namespace cyclorama::camera_calibration
