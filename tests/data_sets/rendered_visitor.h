// SPDX-License-Identifier: Apache-2.0
/// Visitors of textured capsules before a camera, in a furnished room with variable light: pictures with a known truth.
/// The same scene gives the same picture.
///
///   Camera frame: x right, y down, z forward, the floor 1.4 m below. Visitors face the camera, so their right is -x.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/image/image.h"
#include "common/room/pinhole.h"
#include "drivers/simulated/camera/sensor.h"

namespace cyclorama {

struct RenderedVisitor {
  double x_m = 0.0;  ///< Position of the hips.
  double depth_m = 2.0;
  double lean_rad = 0.0;  ///< Lean of everything above the hips; positive to the visitor's right.
  double height_m = 1.72;
  double head_m = 0.155;   ///< Width of the head.
  double arms_rad = 0.12;  ///< Angle from hanging straight.
  float shirt_grey = 60.0f;
  float skin_grey = 170.0f;
  float hair_grey = 40.0f;
  double pattern_phase = 0.0;  ///< Phase of the shirt's stripes.
};

struct RenderedLight {
  double gain = 1.0;
  double lamp = 0.0;    ///< Additional brightness in the centre of a lamp's cone, as a fraction of `gain`.
  double lamp_u = 0.3;  ///< Position as a fraction of the picture's width and height.
  double lamp_v = 0.2;
};

/// Immutable; reentrant.
class VisitorRoom {
 public:
  VisitorRoom(const Pinhole& lens, std::uint32_t seed, double noise_grey = 1.5);
  [[nodiscard]] GreyImage picture(const std::vector<RenderedVisitor>& visitors, const RenderedLight& light,
                                  std::uint64_t number) const;
  [[nodiscard]] const Pinhole& lens() const { return lens_; }

 private:
  Pinhole lens_;
  Image<float, 1> room_;
  simulated::Sensor sensor_;
};

}  // namespace cyclorama
