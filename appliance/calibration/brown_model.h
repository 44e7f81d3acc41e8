// SPDX-License-Identifier: Apache-2.0
/// Brown's lens model: the distortion of a slope (x/z, y/z), as a formula that solvers can also differentiate.
///
///   r² = x² + y²        R = 1 + k1 r² + k2 r⁴ + k3 r⁶
///   x' = x R + 2 p1 x y + p2 (r² + 2 x²)
///   y' = y R + p1 (r² + 2 y²) + 2 p2 x y             u = fu x' + cu,  v = fv y' + cv
///
/// Source: Brown, "Decentering Distortion of Lenses", Photogrammetric Engineering 32 (3), 1966; the coefficients are in
/// OpenCV's order (k1, k2, p1, p2, k3). The CENTRE of the first pixel is at (0.5, 0.5), so OpenCV's centre (cx, cy) is
/// (cu - 0.5, cv - 0.5).
#pragma once

#include <array>

namespace cyclorama::calibration {

/// Parameters of a lens: focal lengths and principal point in pixels, and dimensionless coefficients.
struct BrownParameters {
  int width_px = 0;
  int height_px = 0;
  double focal_u_px = 0.0;
  double focal_v_px = 0.0;
  double centre_u_px = 0.0;
  double centre_v_px = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;
};

/// The parameters as one block of numbers, for solvers.
inline constexpr int kBrownValues = 9;
enum BrownValue : int { kFocalU, kFocalV, kCentreU, kCentreV, kK1, kK2, kP1, kP2, kK3 };
using BrownBlock = std::array<double, kBrownValues>;

[[nodiscard]] constexpr BrownBlock to_block(const BrownParameters& lens) {
  return {lens.focal_u_px, lens.focal_v_px, lens.centre_u_px, lens.centre_v_px, lens.k1,
          lens.k2,         lens.p1,         lens.p2,          lens.k3};
}
[[nodiscard]] constexpr BrownParameters from_block(const BrownBlock& block, int width_px, int height_px) {
  return {width_px,   height_px,  block[kFocalU], block[kFocalV], block[kCentreU], block[kCentreV],
          block[kK1], block[kK2], block[kP1],     block[kP2],     block[kK3]};
}

/// Computes the pixel (u, v) of the slope (x, y). `block`: see BrownBlock. T is double or an automatic differentiation
/// type.
template <typename T>
void brown_pixel(const T* block, const T& x, const T& y, T* u, T* v) {
  const T xx = x * x;
  const T yy = y * y;
  const T xy2 = 2.0 * x * y;
  const T rr = xx + yy;
  const T radial = 1.0 + rr * (block[kK1] + rr * (block[kK2] + rr * block[kK3]));
  *u = block[kFocalU] * (x * radial + block[kP1] * xy2 + block[kP2] * (rr + 2.0 * xx)) + block[kCentreU];
  *v = block[kFocalV] * (y * radial + block[kP1] * (rr + 2.0 * yy) + block[kP2] * xy2) + block[kCentreV];
}

}  // namespace cyclorama::calibration
