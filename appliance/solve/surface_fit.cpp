// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/surface_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/solve/surface_problem.h"
#include "appliance/solve/uncertainty.h"

namespace cyclorama::solve {
namespace {

constexpr double kMissed_px = 100.0;

void add_covariance(const SurfaceProblem& problem, calibration::SurfaceFit* fit) {
  const std::vector<double> scales = problem.scales();
  const Uncertainty uncertainty = uncertainty_of(problem.normal(false), problem.normal(true), scales);
  fit->rank = uncertainty.rank;
  fit->parameters = static_cast<int>(scales.size());
  const int size = fit->surface.size();
  for (int i = 0; i < size; ++i) fit->surface_sigmas.push_back(std::sqrt(uncertainty.covariance(i, i)));
  Eigen::Index at = size;
  const std::vector<int>& free = problem.free_of_lens();
  for (calibration::FittedProjector& projector : fit->projectors) {
    projector.pose_covariance = uncertainty.covariance.block<6, 6>(at, at);
    projector.lens.covariance.setZero();
    at += 6;
    for (std::size_t i = 0; i < free.size(); ++i) {
      for (std::size_t j = 0; j < free.size(); ++j) {
        projector.lens.covariance(free[i], free[j]) =
            uncertainty.covariance(at + static_cast<Eigen::Index>(i), at + static_cast<Eigen::Index>(j));
      }
    }
    at += static_cast<Eigen::Index>(free.size());
  }
}

}  // namespace

Result<calibration::SurfaceFit> fit_surface(const std::vector<MeasuredProjector>& projectors,
                                            std::span<const MapSample> samples, const calibration::SurfaceFit& start,
                                            const SurfaceFitOptions& options) {
  CHECK(start.projectors.size() == projectors.size());
  CHECK(static_cast<int>(start.surface.parameters.size()) == start.surface.size());
  SurfaceProblem problem(projectors, samples, start, options.lens);
  const auto cost = minimise_robustly(&problem, options.is_from_afar, {options.max_steps});
  if (!cost) {
    return Error(ErrorCode::kBadData,
                 fmt::format("no {} fits from this start; give the projectors' places more exactly",
                             calibration::name_of(start.surface.model)));
  }
  calibration::SurfaceFit fit = problem.found(*cost);
  if (options.with_covariance) add_covariance(problem, &fit);
  return fit;
}

Result<calibration::SurfaceFit> surface_start(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m) {
  calibration::SurfaceFit start;
  std::vector<std::size_t> seen(projectors.size(), 0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const MapSample& sample : samples) {
    CHECK(sample.projector < projectors.size());
    ++seen[sample.projector];
    sum += sample.direction;
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    constexpr std::size_t kMinSamples = 30;
    if (!projectors[p].position) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("projector '{}' has no place in the installation, and a wall is found by them; measure "
                               "about where it stands",
                               projectors[p].name));
    }
    if (seen[p] < kMinSamples) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("projector '{}' was seen at {} places, {} are needed; look whether it shines",
                               projectors[p].name, seen[p], kMinSamples));
    }
    calibration::FittedProjector projector;
    projector.lens = projectors[p].position->lens;
    projector.T_eye_projector = projectors[p].position->T_eye_projector;
    start.projectors.push_back(projector);
  }
  calibration::Surface& surface = start.surface;
  surface.distance_m = wall_distance_m;
  Eigen::Vector3d back = Eigen::Vector3d::UnitZ();
  if (sum.norm() > 1e-6 * static_cast<double>(samples.size())) back = -sum.normalized();
  Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(back);
  // If the view is straight up or down, any horizontal vector works.
  if (!(right.norm() > 1e-3)) right = Eigen::Vector3d::UnitX();
  right.normalize();
  surface.R_eye_wall << right, back.cross(right), back;
  surface.model = calibration::SurfaceModel::kPlane;
  surface.parameters = {0.0, 0.0};
  return start;
}

double prediction_error_px(const calibration::SurfaceFit& fit, std::span<const MapSample> samples) {
  std::vector<double> squares;
  for (const MapSample& sample : samples) {
    const calibration::FittedProjector& projector = fit.projectors[sample.projector];
    const auto inverse_depth = fit.surface.inverse_depth_at(sample.direction);
    const Eigen::Vector3d point =
        projector.T_eye_projector.rotation().conjugate() *
        (sample.direction - inverse_depth.value_or(0.0) * projector.T_eye_projector.translation());
    double square = kMissed_px * kMissed_px;
    if (inverse_depth && point.z() > 1e-4) {
      Eigen::Vector2d pixel;
      calibration::project_through_lens(projector.lens.values.data(), point.data(), pixel.data());
      square = std::min(square, 0.5 * (pixel - sample.projector_px).squaredNorm());
    }
    squares.push_back(square);
  }
  if (squares.empty()) return 0.0;
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

}  // namespace cyclorama::solve
