// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/camera_response.h"

#include "appliance/photometry/cubic_basis.h"

namespace cyclorama::photometry {

CameraResponse CameraResponse::linear(int intervals) {
  CameraResponse response;
  // A cubic B-spline whose coefficients are the positions of its knots is the identity.
  for (int i = -1; i <= intervals + 1; ++i) response.coefficients.push_back(static_cast<double>(i) / intervals);
  return response;
}

double CameraResponse::light_of(double code) const {
  const CubicWeights w = cubic_weights(code * intervals(), intervals());
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += w.value.at(i) * coefficients[static_cast<std::size_t>(w.first) + i];
  return sum;
}

double CameraResponse::slope_at(double code) const {
  const CubicWeights w = cubic_weights(code * intervals(), intervals());
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) sum += w.slope.at(i) * coefficients[static_cast<std::size_t>(w.first) + i];
  return sum * intervals();
}

double CameraResponse::dark_code() const {
  constexpr int kSteps = 4096;
  for (int i = 0; i <= kSteps; ++i) {
    const double code = static_cast<double>(i) / kSteps;
    if (light_of(code) >= 0.0) return code;
  }
  return 1.0;
}

}  // namespace cyclorama::photometry
