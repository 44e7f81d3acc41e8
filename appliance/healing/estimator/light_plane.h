// SPDX-License-Identifier: Apache-2.0
/// Pictures as planes of grey light, smaller than they were: what prediction and measurement work on.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "appliance/calibration/show_calibration.h"
#include "common/image/image.h"

namespace cyclorama::healing {

/// Linear light. `factor` pixels of the original each way are one here; the original's pixel (u, v), counted from its
/// corner, is at (u, v) / factor.
struct LightPlane {
  int factor = 1;
  Image<float, 1> light;

  [[nodiscard]] int width() const { return light.width(); }
  [[nodiscard]] int height() const { return light.height(); }
  /// Bilinear between pixels' centres; beyond its edges there is none. x, y in this plane's pixels, from its corner.
  [[nodiscard]] float at(float x, float y) const;
};

/// What a projector shines for a picture. Reentrant.
[[nodiscard]] LightPlane shone_light(const RgbImage& picture, const calibration::ShowProjector& projector, int factor);
/// What a camera saw. `ret_blown` is the part of pixels at the code's upper end. Reentrant.
[[nodiscard]] LightPlane seen_light(const GreyImage& picture, const calibration::ShowCamera& camera, int factor,
                                    double* ret_blown);

/// Every second pixel each way, of a plane smoothed by 1 2 1 both ways.
[[nodiscard]] LightPlane halved(const LightPlane& plane);
/// 1 2 1 both ways, in place: takes a sensor's noise and half of the difference in sharpness.
void soften(LightPlane* plane);

}  // namespace cyclorama::healing
