// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/lens/measured_lens.h"

namespace cyclorama {

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

std::vector<int> held_parameters(LensRung rung) {
  using L = MeasuredLens;
  switch (rung) {
    case LensRung::kPinhole:
      return {L::kK1, L::kK2, L::kK3, L::kP1, L::kP2};
    case LensRung::kRadial1:
      return {L::kK2, L::kK3, L::kP1, L::kP2};
    case LensRung::kRadial2:
      return {L::kK3, L::kP1, L::kP2};
    case LensRung::kDecentred:
      return {L::kK3};
    case LensRung::kFull:
    case LensRung::kFullOblong:
      return {};
  }
  return {};
}

std::optional<Eigen::Vector3d> direction_through(const BrownLens& lens, const Eigen::Vector2d& pixel) {
  const SlopeAnswer answer = lens.slope_at(pixel);
  if (!answer) return std::nullopt;
  return Eigen::Vector3d(answer.slope.x(), answer.slope.y(), 1.0);
}

}  // namespace cyclorama
