// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/solve/plate_cost.h"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/LU>

namespace cyclorama {
namespace {

class SightCost {
 public:
  SightCost(const CellMean& seen, double wall_nearness)
      : camera_px_(seen.camera_px),
        whitening_(seen.camera_per_projector.inverse() / seen.sigma_px),
        wall_nearness_(wall_nearness) {}

  template <typename T>
  bool operator()(const T* lens, const T* mount, const T* offset, const T* angle, const T* direction, const T* nearness,
                  T* ret_residuals) const {
    T point[3];
    to_camera(mount, offset, angle[0], direction, wall_nearness_ + nearness_at(nearness, direction), point);
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
  double wall_nearness_;
};

class KnownSightCost {
 public:
  explicit KnownSightCost(const KnownSight& known) : known_(known) {}

  template <typename T>
  bool operator()(const T* direction, const T* turn, T* ret_residuals) const {
    const Eigen::Vector3d& k = known_.direction;
    // The turn is small: another one went before.
    const T turned[3] = {k.x() + turn[1] * k.z() - turn[2] * k.y(), k.y() + turn[2] * k.x() - turn[0] * k.z(),
                         k.z() + turn[0] * k.y() - turn[1] * k.x()};
    for (int i = 0; i < 3; ++i) ret_residuals[i] = (turned[i] - direction[i]) / known_.sigma_rad;
    return true;
  }

 private:
  KnownSight known_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> make_sight_cost(const CellMean& seen, double wall_nearness) {
  return std::make_unique<
      ceres::AutoDiffCostFunction<SightCost, 2, MeasuredLens::kParameters, 2, 2, 1, 3, kNearnessTerms>>(
      new SightCost(seen, wall_nearness));
}

std::unique_ptr<ceres::CostFunction> make_known_sight_cost(const KnownSight& known) {
  return std::make_unique<ceres::AutoDiffCostFunction<KnownSightCost, 3, 3, 3>>(new KnownSightCost(known));
}

}  // namespace cyclorama
