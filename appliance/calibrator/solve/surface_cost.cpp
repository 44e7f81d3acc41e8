// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/surface_cost.h"

// Before Ceres' headers, whose glog has a CHECK of its own.
#include "appliance/calibrator/lens/measured_lens.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>

namespace cyclorama {
namespace {

constexpr double kScaleSigma = 1e-5;  // Relative: the scale is a gauge, not a measurement.

/// What follows once the nearness is known. Blocks: nearness (1), turn (3), place (3), lens (8).
class LitCost {
 public:
  LitCost(const SurfaceSample& sample, const Eigen::Matrix3d& R_eye_projector)
      : sample_(sample), R_projector_eye_(R_eye_projector.transpose()) {}

  template <typename T>
  bool operator()(const T* nearness, const T* turn, const T* place, const T* lens, T* ret_residuals) const {
    T moved[3];
    for (int i = 0; i < 3; ++i) moved[i] = sample_.direction[i] - nearness[0] * place[i];
    T seen[3];
    for (int i = 0; i < 3; ++i) {
      seen[i] =
          R_projector_eye_(i, 0) * moved[0] + R_projector_eye_(i, 1) * moved[1] + R_projector_eye_(i, 2) * moved[2];
    }
    const T back[3] = {-turn[0], -turn[1], -turn[2]};
    T point[3];
    ceres::AngleAxisRotatePoint(back, seen, point);
    if (!(point[2] > 1e-4)) return false;
    T pixel[2];
    project_through_lens(lens, point, pixel);
    for (int i = 0; i < 2; ++i) ret_residuals[i] = (pixel[i] - sample_.projector_px[i]) / sample_.sigma_px;
    return true;
  }

 private:
  SurfaceSample sample_;
  Eigen::Matrix3d R_projector_eye_;
};

class SurfaceCost : public ceres::CostFunction {
 public:
  SurfaceCost(const Surface& shape, const SurfaceSample& sample, const Eigen::Matrix3d& R_eye_projector)
      : shape_(shape), direction_(sample.direction), lit_(new LitCost(sample, R_eye_projector)) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {shape.size(), 3, 3, MeasuredLens::kParameters};
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int size = parameter_block_sizes()[0];
    const bool wants_surface = jacobians != nullptr && jacobians[0] != nullptr;
    std::vector<double> slopes(wants_surface ? static_cast<std::size_t>(size) : 0);
    const auto nearness = shape_.nearness_at(parameters[0], direction_, wants_surface ? slopes.data() : nullptr);
    if (!nearness) return false;
    const double* inner[] = {&*nearness, parameters[1], parameters[2], parameters[3]};
    if (jacobians == nullptr) return lit_.Evaluate(inner, residuals, nullptr);
    double by_nearness[2];
    double* inner_jacobians[] = {wants_surface ? by_nearness : nullptr, jacobians[1], jacobians[2], jacobians[3]};
    if (!lit_.Evaluate(inner, residuals, inner_jacobians)) return false;
    for (int r = 0; wants_surface && r < 2; ++r) {
      for (int i = 0; i < size; ++i) jacobians[0][r * size + i] = by_nearness[r] * slopes[static_cast<std::size_t>(i)];
    }
    return true;
  }

 private:
  const Surface& shape_;
  Eigen::Vector3d direction_;
  ceres::AutoDiffCostFunction<LitCost, 2, 1, 3, 3, MeasuredLens::kParameters> lit_;
};

/// Linear in the parameters but for the scale, whose slope the surface gives.
class SplinePrior : public ceres::CostFunction {
 public:
  SplinePrior(const Surface& shape, double bend_sigma) : shape_(shape), weight_(shape.distance_m / bend_sigma) {
    const int first = shape.rung == SurfaceRung::kProfile ? 2 : 0;
    const int columns = shape.across.coefficients();
    const int rows = shape.rung == SurfaceRung::kProfile ? 1 : shape.up.coefficients();
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const int at = first + y * columns + x;
        if (x + 2 < columns) bends_.push_back({at, at + 1, at + 2});
        if (y + 2 < rows) bends_.push_back({at, at + columns, at + 2 * columns});
      }
    }
    set_num_residuals(static_cast<int>(bends_.size()) + 1);
    *mutable_parameter_block_sizes() = {shape.size()};
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* p = parameters[0];
    const int size = parameter_block_sizes()[0];
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    if (jacobian != nullptr) std::fill(jacobian, jacobian + num_residuals() * size, 0.0);
    for (std::size_t i = 0; i < bends_.size(); ++i) {
      const auto& [a, b, c] = bends_[i];
      residuals[i] = weight_ * (p[a] - 2.0 * p[b] + p[c]);
      if (jacobian == nullptr) continue;
      double* row = jacobian + i * static_cast<std::size_t>(size);
      row[a] = weight_;
      row[b] = -2.0 * weight_;
      row[c] = weight_;
    }
    const std::size_t last = bends_.size();
    double* row = jacobian != nullptr ? jacobian + last * static_cast<std::size_t>(size) : nullptr;
    const auto nearness = shape_.nearness_at(p, -shape_.R_eye_wall.col(2), row);
    if (!nearness) return false;
    const double scale = shape_.distance_m / kScaleSigma;
    residuals[last] = scale * (*nearness - 1.0 / shape_.distance_m);
    for (int i = 0; row != nullptr && i < size; ++i) row[i] *= scale;
    return true;
  }

 private:
  const Surface& shape_;
  double weight_;
  std::vector<std::array<int, 3>> bends_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> make_surface_cost(const Surface& shape, const SurfaceSample& sample,
                                                       const Eigen::Matrix3d& R_eye_projector) {
  return std::make_unique<SurfaceCost>(shape, sample, R_eye_projector);
}

std::unique_ptr<ceres::CostFunction> make_spline_prior(const Surface& shape, double bend_sigma) {
  return std::make_unique<SplinePrior>(shape, bend_sigma);
}

}  // namespace cyclorama
