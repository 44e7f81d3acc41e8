// SPDX-License-Identifier: Apache-2.0
/// Embree geometries of lamps that rays can hit, and the mapping from a hit back to the lamp.
#pragma once

#include <array>
#include <vector>

#include "renderfarm/render/embree.h"
#include "renderfarm/render/lights/light_set.h"

namespace cyclorama::render {

/// Maps hits on the geometries of attach_lamps() to lamps. A value.
///
///     if (lamps.holds(hit.geomID)) light = lamps.light_of(hit.geomID, hit.primID);
///
/// Check holds() before a hit is taken for a placement: a lamp is in the top-level scene itself, with hit.instID[0]
/// invalid.
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

/// Adds the visible lamps of `lights` to `top`, before it is committed, as up to three geometries with ids from
/// `first`; the placements have lower ids. The geometries have no user data and no filters. Errors are left in
/// `device`, for the caller to check.
[[nodiscard]] LampGeometries attach_lamps(const LightSet& lights, unsigned first, RTCDevice device, RTCScene top);

}  // namespace cyclorama::render
