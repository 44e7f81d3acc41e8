// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/measured_lens.h"

namespace cyclorama::calibration {

MeasuredLens MeasuredLens::from_focal(int width_px, int height_px, double focal_px) {
  MeasuredLens lens;
  lens.width_px = width_px;
  lens.height_px = height_px;
  lens.values = {focal_px, 0.5 * width_px, 0.5 * height_px, 0.0, 0.0, 0.0, 0.0, 0.0};
  const double centre = width_px / 50.0;
  const double sigmas[kParameters] = {focal_px / 20.0, centre, centre, 0.1, 0.1, 1e-6, 2e-3, 2e-3};
  for (int i = 0; i < kParameters; ++i) lens.covariance(i, i) = sigmas[i] * sigmas[i];
  return lens;
}

Result<BrownLens> MeasuredLens::brown() const {
  return BrownLens::from({width_px, height_px, values[kFocal], values[kFocal], values[kCentreU], values[kCentreV],
                          values[kK1], values[kK2], values[kP1], values[kP2], values[kK3]});
}

std::optional<Eigen::Vector2d> MeasuredLens::pixel_of(const Eigen::Vector3d& point) const {
  const auto lens = brown();
  if (!lens) return std::nullopt;
  return lens->pixel_of(point);
}

std::optional<Eigen::Vector3d> MeasuredLens::direction_at(const Eigen::Vector2d& pixel) const {
  const auto lens = brown();
  if (!lens) return std::nullopt;
  return direction_through(*lens, pixel);
}

std::vector<int> held_parameters(LensModel model) {
  using L = MeasuredLens;
  switch (model) {
    case LensModel::kPinhole:
      return {L::kK1, L::kK2, L::kK3, L::kP1, L::kP2};
    case LensModel::kRadial1:
      return {L::kK2, L::kK3, L::kP1, L::kP2};
    case LensModel::kRadial2:
      return {L::kK3, L::kP1, L::kP2};
    case LensModel::kDecentred:
      return {L::kK3};
    case LensModel::kFull:
    case LensModel::kFullOblong:
      return {};
  }
  return {};
}

std::optional<Eigen::Vector3d> direction_through(const BrownLens& lens, const Eigen::Vector2d& pixel) {
  const SlopeAnswer answer = lens.slope_at(pixel);
  if (!answer) return std::nullopt;
  return Eigen::Vector3d(answer.slope.x(), answer.slope.y(), 1.0);
}

LensSlopes slopes_through_lens(const double* lens, const Eigen::Vector3d& point) {
  using L = MeasuredLens;
  const double x = point.x() / point.z();
  const double y = point.y() / point.z();
  const double xx = x * x;
  const double yy = y * y;
  const double xy2 = 2.0 * x * y;
  const double rr = xx + yy;
  const double radial = 1.0 + rr * (lens[L::kK1] + rr * (lens[L::kK2] + rr * lens[L::kK3]));
  const double per_rr = lens[L::kK1] + rr * (2.0 * lens[L::kK2] + rr * 3.0 * lens[L::kK3]);
  const double focal = lens[L::kFocal];
  const double p1 = lens[L::kP1];
  const double p2 = lens[L::kP2];
  const Eigen::Vector2d bent(x * radial + p1 * xy2 + p2 * (rr + 2.0 * xx),
                             y * radial + p1 * (rr + 2.0 * yy) + p2 * xy2);
  LensSlopes slopes;
  slopes.pixel = focal * bent + Eigen::Vector2d(lens[L::kCentreU], lens[L::kCentreV]);
  const double across = radial + 2.0 * per_rr * xx + 2.0 * p1 * y + 6.0 * p2 * x;
  const double mixed = per_rr * xy2 + 2.0 * p1 * x + 2.0 * p2 * y;
  const double down = radial + 2.0 * per_rr * yy + 6.0 * p1 * y + 2.0 * p2 * x;
  const double scale = focal / point.z();
  slopes.by_point << scale * across, scale * mixed, -scale * (across * x + mixed * y),  //
      scale * mixed, scale * down, -scale * (mixed * x + down * y);
  const Eigen::Vector2d ray = focal * Eigen::Vector2d(x, y);
  slopes.by_lens.col(L::kFocal) = bent;
  slopes.by_lens.col(L::kCentreU) = Eigen::Vector2d::UnitX();
  slopes.by_lens.col(L::kCentreV) = Eigen::Vector2d::UnitY();
  slopes.by_lens.col(L::kK1) = rr * ray;
  slopes.by_lens.col(L::kK2) = rr * rr * ray;
  slopes.by_lens.col(L::kK3) = rr * rr * rr * ray;
  slopes.by_lens.col(L::kP1) = focal * Eigen::Vector2d(xy2, rr + 2.0 * yy);
  slopes.by_lens.col(L::kP2) = focal * Eigen::Vector2d(rr + 2.0 * xx, xy2);
  return slopes;
}

}  // namespace cyclorama::calibration
