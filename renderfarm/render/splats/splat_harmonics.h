// SPDX-License-Identifier: Apache-2.0
/// Real spherical harmonics of degree 0 to 3 with the signs and the order of the original splatting program. Source:
/// Kerbl et al. 2023, and KHR_gaussian_splatting, appendix A.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace cyclorama::render {

inline constexpr std::size_t kMaxSplatCoefficients = 16;

/// Returns the value of each of the first `count` functions for a unit direction.
template <typename Number>
[[nodiscard]] std::array<Number, kMaxSplatCoefficients> splat_harmonics(Number x, Number y, Number z,
                                                                        std::size_t count) {
  const auto c = [](double value) { return static_cast<Number>(value); };
  std::array<Number, kMaxSplatCoefficients> value{};
  value[0] = c(0.28209479177387814);
  if (count <= 1) return value;
  value[1] = c(-0.4886025119029199) * y;
  value[2] = c(0.4886025119029199) * z;
  value[3] = c(-0.4886025119029199) * x;
  if (count <= 4) return value;
  value[4] = c(1.0925484305920792) * x * y;
  value[5] = c(-1.0925484305920792) * y * z;
  value[6] = c(0.31539156525252005) * (2 * z * z - x * x - y * y);
  value[7] = c(-1.0925484305920792) * x * z;
  value[8] = c(0.5462742152960396) * (x * x - y * y);
  if (count <= 9) return value;
  value[9] = c(-0.5900435899266435) * y * (3 * x * x - y * y);
  value[10] = c(2.890611442640554) * x * y * z;
  value[11] = c(-0.4570457994644658) * y * (4 * z * z - x * x - y * y);
  value[12] = c(0.3731763325901154) * z * (2 * z * z - 3 * x * x - 3 * y * y);
  value[13] = c(-0.4570457994644658) * x * (4 * z * z - x * x - y * y);
  value[14] = c(1.445305721320277) * z * (x * x - y * y);
  value[15] = c(-0.5900435899266435) * x * (x * x - 3 * y * y);
  return value;
}

}  // namespace cyclorama::render
