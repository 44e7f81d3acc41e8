// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/procam_solve.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/rotation.h>
#include <ceres/solver.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "appliance/camera_calibration/procam_start.h"

namespace cyclorama::camera_calibration {
namespace {

using PoseBlock = std::array<double, 6>;  ///< Angle-axis, then translation.

using BoardBlock = std::array<double, kBoardValues>;  ///< In the order of BoardShape.

/// All unknowns. Ceres identifies them by address, so `boards` must not be resized while a problem exists.
struct Unknowns {
  calibration::BrownBlock camera = {};
  calibration::BrownBlock projector = {};
  PoseBlock projector_from_camera = {};
  BoardBlock shape = {};
  std::vector<PoseBlock> boards;
};

template <typename T>
void moved(const T* pose, const T* point, T* result) {
  ceres::AngleAxisRotatePoint(pose, point, result);
  for (int i = 0; i < 3; ++i) result[i] += pose[3 + i];
}

/// Converts a constant to T without derivatives. (A cast from double to double would cause a warning.)
template <typename T>
T constant(double value) {
  if constexpr (std::is_same_v<T, double>) {
    return value;
  } else {
    return T(value);
  }
}

/// Computes the reprojection error of a point in the lens's frame: (u, v) minus the observation. Returns false for a
/// point behind the lens.
template <typename T>
bool pixel_error(const T* lens, bool is_square, const T* point, const Eigen::Vector2d& seen, T* error) {
  if (!(point[2] > 1e-6)) return false;
  std::array<T, calibration::kBrownValues> block;
  std::copy_n(lens, calibration::kBrownValues, block.begin());
  if (is_square) block[calibration::kFocalV] = block[calibration::kFocalU];
  const T x = point[0] / point[2];
  const T y = point[1] / point[2];
  T u, v;
  calibration::brown_pixel(block.data(), x, y, &u, &v);
  error[0] = u - seen.x();
  error[1] = v - seen.y();
  return true;
}

/// Computes the position of a corner on the deformed board.
template <typename T>
void shaped(const T* shape, const Eigen::Vector2d& corner, T* point) {
  point[0] = constant<T>(corner.x());
  point[1] = corner.y() * (1.0 + shape[0]);
  point[2] = (corner.x() * corner.x()) * shape[1] + (corner.x() * corner.y()) * shape[2] +
             (corner.y() * corner.y()) * shape[3];
}

struct CameraError {
  Eigen::Vector2d board;
  Eigen::Vector2d seen;
  bool is_square;
  template <typename T>
  bool operator()(const T* lens, const T* shape, const T* pose, T* error) const {
    T point[3];
    T in_camera[3];
    shaped(shape, board, point);
    moved(pose, point, in_camera);
    return pixel_error(lens, is_square, in_camera, seen, error);
  }
};

struct ProjectorError {
  Eigen::Vector2d board;
  Eigen::Vector2d seen;
  bool is_square;
  template <typename T>
  bool operator()(const T* lens, const T* projector_from_camera, const T* shape, const T* pose, T* error) const {
    T point[3];
    T in_camera[3];
    T in_projector[3];
    shaped(shape, board, point);
    moved(pose, point, in_camera);
    moved(projector_from_camera, in_camera, in_projector);
    return pixel_error(lens, is_square, in_projector, seen, error);
  }
};

PoseBlock block_of(const StartPose& pose) {
  PoseBlock block;
  // Ceres reads matrices column-major, as Eigen stores them.
  ceres::RotationMatrixToAngleAxis(pose.R.data(), block.data());
  std::copy_n(pose.t.data(), 3, block.begin() + 3);
  return block;
}

template <typename To, typename From>
RigidTransform<To, From> transform_of(const PoseBlock& block) {
  std::array<double, 4> wxyz = {};
  ceres::AngleAxisToQuaternion(block.data(), wxyz.data());
  return {Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]), Eigen::Vector3d(block[3], block[4], block[5])};
}

template <typename To, typename From>
PoseBlock block_of(const RigidTransform<To, From>& transform) {
  return block_of(StartPose{transform.rotation().toRotationMatrix(), transform.translation()});
}

std::vector<int> held_values(calibration::LensModel model) {
  std::vector<int> held = calibration::fixed_values(model);
  if (calibration::has_square_pixels(model)) held.push_back(calibration::kFocalV);
  return held;
}

void hold(const std::vector<int>& values, double* lens, ceres::Problem* problem) {
  if (values.empty() || !problem->HasParameterBlock(lens)) return;
  // The problem takes ownership.
  problem->SetManifold(lens, new ceres::SubsetManifold(calibration::kBrownValues, values));
}

void add_camera(const BoardView& view, bool is_square, Unknowns* unknowns, PoseBlock* pose, ceres::Problem* problem) {
  for (std::size_t i = 0; i < view.board_m.size(); ++i) {
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<CameraError, 2, calibration::kBrownValues, kBoardValues, 6>(
            new CameraError{view.board_m[i], view.camera_px[i], is_square}),
        nullptr, unknowns->camera.data(), unknowns->shape.data(), pose->data());
  }
}

void add_projector(const BoardView& view, bool is_square, Unknowns* unknowns, PoseBlock* pose,
                   ceres::Problem* problem) {
  for (std::size_t i = 0; i < view.board_m.size(); ++i) {
    problem->AddResidualBlock(
        new ceres::AutoDiffCostFunction<ProjectorError, 2, calibration::kBrownValues, 6, kBoardValues, 6>(
            new ProjectorError{view.board_m[i], view.projector_px[i], is_square}),
        nullptr, unknowns->projector.data(), unknowns->projector_from_camera.data(), unknowns->shape.data(),
        pose->data());
  }
}

/// Minimises, and returns half the sum of squares; nothing if the solver failed.
std::optional<double> minimise(ceres::Problem* problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 300;
  options.function_tolerance = 1e-11;
  options.parameter_tolerance = 1e-10;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  if (!summary.IsSolutionUsable() || !std::isfinite(summary.final_cost)) return std::nullopt;
  return summary.final_cost;
}

double rms(double sum_of_squares, double count) { return std::sqrt(sum_of_squares / std::max(1.0, count)); }

double squares_of(const std::vector<double>& residuals, bool of_camera) {
  // The camera's residuals are the first half, the projector's the second.
  double sum = 0.0;
  const std::size_t half = residuals.size() / 2;
  for (std::size_t i = of_camera ? 0 : half; i < (of_camera ? half : residuals.size()); ++i)
    sum += residuals[i] * residuals[i];
  return sum;
}

Status check(const std::vector<BoardView>& views) {
  if (views.empty()) return Error(ErrorCode::kInvalidArgument, "no views of the board");
  for (const BoardView& view : views) {
    if (view.board_m.size() < 8 || view.camera_px.size() != view.board_m.size() ||
        view.projector_px.size() != view.board_m.size()) {
      return Error(ErrorCode::kInvalidArgument,
                   "a view needs 8 corners or more, each seen by the camera and on the projector");
    }
    const auto is_finite = [](const Eigen::Vector2d& p) { return p.allFinite() && p.norm() < 1e9; };
    for (const auto* points : {&view.board_m, &view.camera_px, &view.projector_px}) {
      if (!std::all_of(points->begin(), points->end(), is_finite)) {
        return Error(ErrorCode::kInvalidArgument, "a corner that is not a finite number");
      }
    }
  }
  return Done{};
}

Error undetermined() {
  return {ErrorCode::kBadData,
          "these views of the board do not determine camera and projector: add one with the board turned by 20 degrees "
          "or more "
          "about another axis, and nearer or further away"};
}

/// Returns initial values for a focal length of the camera: the camera is solved alone, and the boards' poses then give
/// points in space for the projector.
std::optional<Unknowns> started(const std::vector<BoardView>& views, const std::vector<Eigen::Matrix3d>& homographies,
                                const ProcamChoice& choice, double focal_px) {
  Unknowns unknowns;
  const Eigen::Vector2d centre(0.5 * choice.camera.width_px, 0.5 * choice.camera.height_px);
  unknowns.camera = {focal_px, focal_px, centre.x(), centre.y(), 0.0, 0.0, 0.0, 0.0, 0.0};
  for (const Eigen::Matrix3d& h : homographies) unknowns.boards.push_back(block_of(board_pose(h, focal_px, centre)));
  ceres::Problem alone;
  for (std::size_t i = 0; i < views.size(); ++i) add_camera(views[i], true, &unknowns, &unknowns.boards[i], &alone);
  // The principal point stays fixed until the projector's observations constrain it too.
  std::vector<int> held = held_values(calibration::LensModel::kPinhole);
  held.insert(held.end(), {calibration::kCentreU, calibration::kCentreV});
  hold(held, unknowns.camera.data(), &alone);
  alone.SetParameterBlockConstant(unknowns.shape.data());
  if (!minimise(&alone)) return std::nullopt;
  unknowns.camera[calibration::kFocalV] = unknowns.camera[calibration::kFocalU];

  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto T_camera_board = transform_of<frame::Camera, frame::Board>(unknowns.boards[i]);
    for (std::size_t j = 0; j < views[i].board_m.size(); ++j) {
      const Point<frame::Board> corner{{views[i].board_m[j].x(), views[i].board_m[j].y(), 0.0}};
      points.push_back((T_camera_board * corner).xyz);
      pixels.push_back(views[i].projector_px[j]);
    }
  }
  const auto pinhole = pinhole_from(points, pixels);
  if (!pinhole) return std::nullopt;
  unknowns.projector = {
      pinhole->focal_px, pinhole->focal_px, pinhole->centre_px.x(), pinhole->centre_px.y(), 0.0, 0.0, 0.0, 0.0, 0.0};
  unknowns.projector_from_camera = block_of(pinhole->pose);
  return unknowns;
}

void build(const std::vector<BoardView>& views, const ProcamChoice& choice, Unknowns* unknowns,
           ceres::Problem* problem) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    add_camera(views[i], calibration::has_square_pixels(choice.camera_model), unknowns, &unknowns->boards[i], problem);
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    add_projector(views[i], calibration::has_square_pixels(choice.projector_model), unknowns, &unknowns->boards[i],
                  problem);
  }
  hold(held_values(choice.camera_model), unknowns->camera.data(), problem);
  hold(held_values(choice.projector_model), unknowns->projector.data(), problem);
  if (choice.board_model == BoardModel::kFlat) problem->SetParameterBlockConstant(unknowns->shape.data());
}

/// Rank of the Jacobian, whose columns are scaled to length 1, and standard deviations.
struct Certainty {
  int rank = 0;
  std::vector<double> sigmas;  ///< Sigmas of the free parameters: camera, projector, the rest.
};

Certainty certainty_of(Unknowns* unknowns, ceres::Problem* problem) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {unknowns->camera.data(), unknowns->projector.data(),
                              unknowns->projector_from_camera.data()};
  for (PoseBlock& board : unknowns->boards) options.parameter_blocks.push_back(board.data());
  if (!problem->IsParameterBlockConstant(unknowns->shape.data())) {
    options.parameter_blocks.push_back(unknowns->shape.data());
  }
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  problem->Evaluate(options, nullptr, &residuals, nullptr, &sparse);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (auto k = static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row)]);
         k < static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row) + 1]); ++k) {
      jacobian(row, sparse.cols[k]) = sparse.values[k];
    }
  }
  Eigen::VectorXd scales = jacobian.colwise().norm();
  for (double& scale : scales) scale = scale > 0.0 ? scale : 1.0;
  jacobian = jacobian * scales.cwiseInverse().asDiagonal();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinV);
  Certainty certainty;
  const Eigen::VectorXd& values = svd.singularValues();
  // The threshold is about single precision; with a smaller one, rounding errors would count as measurements.
  for (const double value : values) certainty.rank += value > 1e-7 * values[0] ? 1 : 0;
  double squares = 0.0;
  for (const double residual : residuals) squares += residual * residual;
  const double freedom = std::max(1.0, static_cast<double>(jacobian.rows() - jacobian.cols()));
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
    double variance = 0.0;
    for (Eigen::Index k = 0; k < certainty.rank; ++k) variance += std::pow(svd.matrixV()(i, k) / values[k], 2);
    certainty.sigmas.push_back(std::sqrt(variance * squares / freedom) / scales[i]);
  }
  return certainty;
}

/// Assigns standard deviations from `next` on to the free parameters, and returns the index after them. With square
/// pixels the second focal length has the sigma of the first.
std::size_t spread_sigmas(const std::vector<double>& sigmas, std::size_t next, calibration::LensModel model,
                          calibration::BrownBlock* block) {
  const std::vector<int> held = held_values(model);
  for (int i = 0; i < calibration::kBrownValues; ++i) {
    if (std::find(held.begin(), held.end(), i) != held.end()) continue;
    block->at(static_cast<std::size_t>(i)) = sigmas.at(next++);
  }
  if (calibration::has_square_pixels(model)) (*block)[calibration::kFocalV] = (*block)[calibration::kFocalU];
  return next;
}

}  // namespace

Result<ProcamCalibration> solve_procam(const std::vector<BoardView>& views, const ProcamChoice& choice) {
  TRY(check(views));
  std::vector<Eigen::Matrix3d> homographies;
  for (const BoardView& view : views) {
    const auto h = homography(view.board_m, view.camera_px);
    if (!h) return Error(ErrorCode::kInvalidArgument, "a view whose corners lie on a line, or in one place");
    homographies.push_back(*h);
  }
  const Eigen::Vector2d centre(0.5 * choice.camera.width_px, 0.5 * choice.camera.height_px);
  const double guess =
      focal_from(homographies, centre).value_or(1.5 * std::max(choice.camera.width_px, choice.camera.height_px));
  std::optional<Unknowns> best;
  double best_cost = 0.0;
  std::vector<double> costs;
  constexpr std::array<double, kMaxStarts> kFactors = {1.0, 0.6, 1.8};
  for (int start = 0; start < std::clamp(choice.starts, 1, kMaxStarts); ++start) {
    const double factor = kFactors.at(static_cast<std::size_t>(start));
    auto unknowns = started(views, homographies, choice, factor * guess);
    if (!unknowns) continue;
    ceres::Problem problem;
    build(views, choice, &*unknowns, &problem);
    const auto cost = minimise(&problem);
    if (!cost || !(unknowns->camera[calibration::kFocalU] > 0.0) || !(unknowns->projector[calibration::kFocalU] > 0.0))
      continue;
    costs.push_back(*cost);
    if (best && *cost >= best_cost) continue;
    best_cost = *cost;
    best = std::move(unknowns);
  }
  if (!best) return undetermined();
  for (auto [lens, model] :
       {std::pair{&best->camera, choice.camera_model}, std::pair{&best->projector, choice.projector_model}}) {
    if (calibration::has_square_pixels(model)) (*lens)[calibration::kFocalV] = (*lens)[calibration::kFocalU];
  }
  ceres::Problem problem;
  build(views, choice, &*best, &problem);
  const Certainty certainty = certainty_of(&*best, &problem);

  ProcamCalibration result;
  result.unknowns = static_cast<int>(certainty.sigmas.size());
  result.rank = certainty.rank;
  if (result.rank < result.unknowns) return undetermined();
  result.camera = calibration::from_block(best->camera, choice.camera.width_px, choice.camera.height_px);
  result.projector = calibration::from_block(best->projector, choice.projector.width_px, choice.projector.height_px);
  const std::size_t next = spread_sigmas(certainty.sigmas, 0, choice.camera_model, &result.camera_sigma);
  spread_sigmas(certainty.sigmas, next, choice.projector_model, &result.projector_sigma);
  result.board = {best->shape[0], best->shape[1], best->shape[2], best->shape[3]};
  result.T_projector_camera = transform_of<frame::Projector, frame::Camera>(best->projector_from_camera);
  for (const PoseBlock& board : best->boards)
    result.T_camera_board.push_back(transform_of<frame::Camera, frame::Board>(board));
  std::vector<double> residuals;
  problem.Evaluate({}, nullptr, &residuals, nullptr, nullptr);
  const auto corners = static_cast<double>(residuals.size() / 4);
  result.camera_rms_px = rms(squares_of(residuals, true), corners);
  result.projector_rms_px = rms(squares_of(residuals, false), corners);
  result.stereo_rms_px = rms(squares_of(residuals, true) + squares_of(residuals, false), 2.0 * corners);
  for (const double cost : costs) result.starts_agreeing += cost <= best_cost * (1.0 + 1e-6) + 1e-15 ? 1 : 0;
  return result;
}

Result<HeldOut> held_out(const BoardView& view, const ProcamCalibration& calibration) {
  TRY(check({view}));
  const auto h = homography(view.board_m, view.camera_px);
  if (!h) return Error(ErrorCode::kInvalidArgument, "a view whose corners lie on a line, or in one place");
  Unknowns unknowns;
  unknowns.camera = calibration::to_block(calibration.camera);
  unknowns.projector = calibration::to_block(calibration.projector);
  unknowns.projector_from_camera = block_of(calibration.T_projector_camera);
  const BoardShape& board = calibration.board;
  unknowns.shape = {board.stretch, board.bend_xx, board.bend_xy, board.bend_yy};
  const Eigen::Vector2d centre(calibration.camera.centre_u_px, calibration.camera.centre_v_px);
  unknowns.boards = {block_of(board_pose(*h, calibration.camera.focal_u_px, centre))};
  const auto hold_devices = [&unknowns](ceres::Problem* problem) {
    for (double* block : {unknowns.camera.data(), unknowns.projector.data(), unknowns.projector_from_camera.data(),
                          unknowns.shape.data()}) {
      if (problem->HasParameterBlock(block)) problem->SetParameterBlockConstant(block);
    }
  };
  const auto corners = static_cast<double>(view.board_m.size());
  HeldOut result;
  ceres::Problem by_camera;
  add_camera(view, false, &unknowns, unknowns.boards.data(), &by_camera);
  hold_devices(&by_camera);
  const auto cost = minimise(&by_camera);
  if (!cost) return undetermined();
  result.camera_rms_px = rms(2.0 * *cost, corners);

  ceres::Problem by_both;
  add_camera(view, false, &unknowns, unknowns.boards.data(), &by_both);
  add_projector(view, false, &unknowns, unknowns.boards.data(), &by_both);
  hold_devices(&by_both);
  std::vector<double> residuals;
  if (!by_both.Evaluate({}, nullptr, &residuals, nullptr, nullptr)) return undetermined();
  result.projector_rms_px = rms(squares_of(residuals, false), corners);
  const auto both_cost = minimise(&by_both);
  if (!both_cost) return undetermined();
  result.stereo_rms_px = rms(2.0 * *both_cost, 2.0 * corners);
  return result;
}

}  // namespace cyclorama::camera_calibration
