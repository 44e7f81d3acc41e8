// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/show_fit.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace cyclorama::healing {
namespace {

constexpr std::size_t kMinPixels = 40;
constexpr double kGross_px = 1.0;    // Transition of the loss from squares to logarithms.
constexpr double kOutlier_px = 5.0;  // A larger distance counts as an outlier.
constexpr double kMaxRms_px = 20.0;  // A larger rms means that the wall's model is wrong.

struct Reprojection {
  Eigen::Vector2d pixel;
  Eigen::Vector3d position;

  template <typename T>
  bool operator()(const T* pose, const T* lens, T* residual) const {
    // `pose` is T_body_room: an angle-axis rotation, then a shift.
    const T in_room[3] = {T(position.x()), T(position.y()), T(position.z())};
    T point[3];
    ceres::AngleAxisRotatePoint(pose, in_room, point);
    for (int i = 0; i < 3; ++i) point[i] += pose[3 + i];
    if (!(point[2] > T(1e-3))) return false;
    T u;
    T v;
    calibration::brown_pixel(lens, point[0] / point[2], point[1] / point[2], &u, &v);
    residual[0] = u - T(pixel.x());
    residual[1] = v - T(pixel.y());
    return true;
  }
};

/// Prior that keeps a lens parameter near the installation's value.
struct Near {
  int index;
  double value;
  double sigma;
  template <typename T>
  bool operator()(const T* block, T* residual) const {
    residual[0] = (block[index] - T(value)) / T(sigma);
    return true;
  }
};

struct Fit {
  std::array<double, 6> pose{};
  calibration::BrownBlock lens{};
};

template <typename Body>
std::array<double, 6> numbers_of(const RigidTransform<frame::Room, Body>& T_room_body) {
  const auto T = T_room_body.inverse();
  const double q[4] = {T.rotation().w(), T.rotation().x(), T.rotation().y(), T.rotation().z()};
  std::array<double, 6> pose{};
  ceres::QuaternionToAngleAxis(q, pose.data());
  for (int i = 0; i < 3; ++i) pose[static_cast<std::size_t>(3 + i)] = T.translation()[i];
  return pose;
}

template <typename Body>
RigidTransform<frame::Room, Body> pose_of(const std::array<double, 6>& pose) {
  double q[4];
  ceres::AngleAxisToQuaternion(pose.data(), q);
  return RigidTransform<Body, frame::Room>({q[0], q[1], q[2], q[3]}, {pose[3], pose[4], pose[5]}).inverse();
}

/// Refines a fit. If `free_lens`, also fits focal lengths, centre, k1 and k2, each kept near its initial value.
bool refine(std::span<const WallCorrespondence> pixels, bool free_lens, Fit* fit) {
  ceres::Problem problem;
  for (const WallCorrespondence& p : pixels) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Reprojection, 2, 6, calibration::kBrownValues>(
                                 new Reprojection{p.pixel, p.position}),
                             new ceres::CauchyLoss(kGross_px), fit->pose.data(), fit->lens.data());
  }
  if (free_lens) {
    const double focal = fit->lens[calibration::kFocalU];
    const auto near = [&](double* block, int size, int index, double value, double sigma) {
      if (size == 6) {
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Near, 1, 6>(new Near{index, value, sigma}), nullptr,
                                 block);
      } else {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Near, 1, calibration::kBrownValues>(new Near{index, value, sigma}), nullptr,
            block);
      }
    };
    near(fit->lens.data(), calibration::kBrownValues, calibration::kFocalU, fit->lens[calibration::kFocalU],
         0.03 * focal);
    near(fit->lens.data(), calibration::kBrownValues, calibration::kFocalV, fit->lens[calibration::kFocalV],
         0.03 * focal);
    near(fit->lens.data(), calibration::kBrownValues, calibration::kCentreU, fit->lens[calibration::kCentreU],
         0.05 * focal);
    near(fit->lens.data(), calibration::kBrownValues, calibration::kCentreV, fit->lens[calibration::kCentreV],
         0.05 * focal);
    near(fit->lens.data(), calibration::kBrownValues, calibration::kK1, 0.0, 0.1);
    near(fit->lens.data(), calibration::kBrownValues, calibration::kK2, 0.0, 0.1);
    for (int i = 0; i < 6; ++i) near(fit->pose.data(), 6, i, fit->pose[static_cast<std::size_t>(i)], i < 3 ? 0.1 : 0.3);
    problem.SetManifold(
        fit->lens.data(),
        new ceres::SubsetManifold(calibration::kBrownValues, {calibration::kP1, calibration::kP2, calibration::kK3}));
  } else {
    problem.SetParameterBlockConstant(fit->lens.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable();
}

template <typename Body>
Result<FittedPose<Body>> judged(std::span<const WallCorrespondence> pixels, const Fit& fit,
                                const calibration::BrownParameters& lens) {
  FittedPose<Body> made;
  made.lens = calibration::from_block(fit.lens, lens.width_px, lens.height_px);
  made.pose = pose_of<Body>(fit.pose);
  std::vector<double> squared;
  const auto T = made.pose.inverse();
  for (const WallCorrespondence& p : pixels) {
    const auto at = pixel_of(made.lens, (T * Point<frame::Room>{p.position}).xyz);
    squared.push_back(at ? (*at - p.pixel).squaredNorm() : 1e12);
    if (squared.back() < kOutlier_px * kOutlier_px) ++made.used;
  }
  std::ranges::sort(squared);
  const std::size_t max = squared.size() - squared.size() / 20;
  double sum = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < max && i < made.used; ++i, ++counted) sum += squared[i];
  made.rms_px = counted == 0 ? 1e6 : std::sqrt(sum / static_cast<double>(counted));
  if (2 * made.used < pixels.size() || !(made.rms_px < kMaxRms_px) || !made.pose.translation().allFinite()) {
    return Error(ErrorCode::kBadData,
                 fmt::format("no pose fits: only {} of {} pixels agree; is the wall what installation.toml says?",
                             made.used, pixels.size()));
  }
  return made;
}

Error too_few(std::size_t count) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("only {} places on the wall are known, {} are needed", count, kMinPixels)};
}

}  // namespace

Result<FittedPose<frame::Projector>> fit_projector(const calibration::MeasuredMap& map, const Wall& wall,
                                                   const Point<frame::Room>& sweet_spot,
                                                   const calibration::ShowProjector& installed) {
  constexpr int kAcross = 32;
  constexpr int kDown = 18;
  std::vector<WallCorrespondence> pixels;
  for (int i = 0; i < kAcross * kDown; ++i) {
    const Eigen::Vector2d pixel((i % kAcross + 0.5) / kAcross * map.width_px,
                                (i / kAcross + 0.5) / kDown * map.height_px);
    const auto direction = map.direction_at(pixel);
    if (!direction) continue;
    const auto position = hit_extended(wall, {{sweet_spot.xyz}, *direction});
    if (position) pixels.push_back({pixel, position->xyz});
  }
  if (pixels.size() < kMinPixels) return too_few(pixels.size());
  Fit fit{numbers_of(installed.T_room_projector), calibration::to_block(installed.lens)};
  if (!refine(pixels, true, &fit)) return Error(ErrorCode::kBadData, "no pose fits where its light lands");
  return judged<frame::Projector>(pixels, fit, installed.lens);
}

Result<FittedPose<frame::Camera>> place_camera(const calibration::BrownParameters& lens,
                                               std::span<const WallCorrespondence> pixels) {
  if (pixels.size() < kMinPixels) return too_few(pixels.size());
  std::vector<cv::Point3d> positions;
  std::vector<cv::Point2d> slopes;
  for (const WallCorrespondence& p : pixels) {
    const auto slope = calibration::slope_at(lens, p.pixel);
    if (!slope) continue;
    positions.emplace_back(p.position.x(), p.position.y(), p.position.z());
    slopes.emplace_back(slope->x(), slope->y());
  }
  if (positions.size() < kMinPixels) return too_few(positions.size());
  Fit fit;
  fit.lens = calibration::to_block(lens);
  try {
    cv::Mat turn;
    cv::Mat shift;
    cv::theRNG().state = 1;  // A fixed seed makes the result reproducible.
    const double within = kOutlier_px / lens.focal_u_px;
    if (!cv::solvePnPRansac(positions, slopes, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turn, shift, false, 2000,
                            static_cast<float>(within), 0.999, cv::noArray(), cv::SOLVEPNP_SQPNP))
      return Error(ErrorCode::kBadData, "no pose fits what the camera sees of the wall");
    for (int i = 0; i < 3; ++i) {
      fit.pose[static_cast<std::size_t>(i)] = turn.at<double>(i);
      fit.pose[static_cast<std::size_t>(3 + i)] = shift.at<double>(i);
    }
  } catch (const cv::Exception& e) {
    return Error(ErrorCode::kBadData, std::string("OpenCV: ") + e.what());
  }
  if (!refine(pixels, false, &fit)) return Error(ErrorCode::kBadData, "no pose fits what the camera sees of the wall");
  return judged<frame::Camera>(pixels, fit, lens);
}

calibration::BrownParameters smaller_lens(const calibration::BrownParameters& lens, int factor) {
  calibration::BrownParameters made = lens;
  made.width_px = lens.width_px / factor;
  made.height_px = lens.height_px / factor;
  for (double* const length : {&made.focal_u_px, &made.focal_v_px, &made.centre_u_px, &made.centre_v_px})
    *length /= factor;
  return made;
}

}  // namespace cyclorama::healing
