// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/plate_cost.h"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/LU>

namespace cyclorama {
namespace {

class SightCost {
 public:
  explicit SightCost(const CellMean& seen)
      : camera_px_(seen.camera_px), whitening_(seen.camera_per_projector.inverse() / seen.sigma_px) {}

  template <typename T>
  bool operator()(const T* lens, const T* mount, const T* offset, const T* angle, const T* direction, const T* nearness,
                  T* ret_residuals) const {
    T point[3];
    to_camera(mount, offset, angle[0], direction, nearness_at(nearness, direction), point);
    if (!(point[2] > 1e-6)) return false;
    T pixel[2];
    project_through_lens(lens, point, pixel);
    const T u = pixel[0] - camera_px_.x();
    const T v = pixel[1] - camera_px_.y();
    ret_residuals[0] = whitening_(0, 0) * u + whitening_(0, 1) * v;
    ret_residuals[1] = whitening_(1, 0) * u + whitening_(1, 1) * v;
    return true;
  }

 private:
  Eigen::Vector2d camera_px_;
  Eigen::Matrix2d whitening_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> make_sight_cost(const CellMean& seen) {
  return std::make_unique<
      ceres::AutoDiffCostFunction<SightCost, 2, MeasuredLens::kParameters, 2, 2, 1, 3, kNearnessTerms>>(
      new SightCost(seen));
}

}  // namespace cyclorama
