// SPDX-License-Identifier: Apache-2.0
/// Writes Gaussian splats as PLY text.
#pragma once

#include <array>
#include <string>

namespace cyclorama {

inline std::string splat_ply_header(int count, int degree) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                     "\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\n";
  const int rest = 3 * ((degree + 1) * (degree + 1) - 1);
  for (int i = 0; i < rest; ++i) text += "property float f_rest_" + std::to_string(i) + "\n";
  text += "property float opacity\n";
  for (int i = 0; i < 3; ++i) text += "property float scale_" + std::to_string(i) + "\n";
  for (int i = 0; i < 4; ++i) text += "property float rot_" + std::to_string(i) + "\n";
  return text + "end_header\n";
}

/// Returns the row of a half-transparent grey splat whose coefficients beyond degree 0 are 1, 2, 3 ...
inline std::string splat_ply_row(const std::array<double, 3>& place, int degree) {
  std::string text;
  for (const double part : place) text += std::to_string(part) + " ";
  text += "0 0 0 ";
  const int rest = 3 * ((degree + 1) * (degree + 1) - 1);
  for (int i = 0; i < rest; ++i) text += std::to_string(i + 1) + " ";
  return text + "0 -1 -1 -1 2 0 0 0\n";
}

}  // namespace cyclorama
