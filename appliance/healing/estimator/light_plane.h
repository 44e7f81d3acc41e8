// SPDX-License-Identifier: Apache-2.0
/// Pictures as planes of grey light at reduced size, for prediction and measurement.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "appliance/calibration/show_calibration.h"
#include "common/image/image.h"

namespace cyclorama::healing {

/// Linear light. One pixel of the plane is `factor` by `factor` pixels of the original; the original's pixel (u, v),
/// counted from its corner, is at (u, v) / factor.
struct LightPlane {
  int factor = 1;
  Image<float, 1> light;

  [[nodiscard]] int width() const { return light.width(); }
  [[nodiscard]] int height() const { return light.height(); }
  /// Returns the light at x, y (in this plane's pixels, from its corner), interpolated bilinearly; 0 beyond the edges.
  [[nodiscard]] float at(float x, float y) const;
};

/// Returns the light that a projector emits for a picture. Reentrant.
[[nodiscard]] LightPlane shone_light(const RgbImage& picture, const calibration::ShowProjector& projector, int factor);
/// Returns the light that a camera saw. `ret_blown` is the share of pixels at the maximum code. Reentrant.
[[nodiscard]] LightPlane seen_light(const GreyImage& picture, const calibration::ShowCamera& camera, int factor,
                                    double* ret_blown);

/// Returns the plane at half the size: smoothed by 1 2 1 both ways, then averaged over 2×2 pixels.
[[nodiscard]] LightPlane halved(const LightPlane& plane);
/// Smooths by 1 2 1 both ways, in place: reduces a sensor's noise, and the difference in sharpness between prediction
/// and picture.
void soften(LightPlane* plane);

}  // namespace cyclorama::healing
