// SPDX-License-Identifier: Apache-2.0
/// Lamps that rays meet: their shapes for Embree, and back from a hit to the lamp.
#pragma once

#include <array>
#include <vector>

#include "renderfarm/render/embree.h"
#include "renderfarm/render/lights/light_set.h"

namespace cyclorama {

/// Which lamp a hit on one of attach_lamps()'s geometries is. A value.
///
///     if (lamps.holds(hit.geomID)) light = lamps.light_of(hit.geomID, hit.primID);
///
/// Asked before instances are: a lamp stands in the top scene itself, with hit.instID[0] invalid.
class LampGeometries {
 public:
  [[nodiscard]] bool holds(unsigned geometry) const { return geometry >= first_ && geometry - first_ < kShapes; }
  /// Precondition: holds(geometry).
  [[nodiscard]] LightIndex light_of(unsigned geometry, unsigned primitive) const {
    return lights_[geometry - first_][primitive];
  }

 private:
  friend LampGeometries attach_lamps(const LightSet& lights, unsigned first, RTCDevice device, RTCScene top);
  static constexpr unsigned kShapes = 3;  ///< Quads, discs, spheres.
  unsigned first_ = RTC_INVALID_GEOMETRY_ID;
  std::array<std::vector<LightIndex>, kShapes> lights_;
};

/// Adds the visible lamps of `lights` to `top`, before it is committed, as at most three geometries from id `first` on;
/// placements come before. They have no user data and no filters. What goes wrong is left in the device's error.
[[nodiscard]] LampGeometries attach_lamps(const LightSet& lights, unsigned first, RTCDevice device, RTCScene top);

}  // namespace cyclorama
