// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::walkable {

/// Traces rays through a scene's geometry to find positions of surfaces, not their appearance. Results are exact,
/// unlike those of the coarse SpaceGrid. Surfaces with blending materials, such as light shafts, fog and some panes,
/// are not obstacles and are left out.
///
/// Borrows the triangles' indices from the scene, which must outlive the probe and not change. Reentrant.
class RayProbe {
 public:
  /// Builds the BVH of `scene`. Rays are most precise near the position `near`, relative to which all geometry is
  /// placed. Errors: kSystem if Embree fails, for example for lack of memory.
  static Result<RayProbe> build(const scene::Scene& scene, const Eigen::Vector3d& near);
  RayProbe(RayProbe&&) noexcept;
  RayProbe& operator=(RayProbe&&) noexcept;
  ~RayProbe();

  static constexpr int kBatch = 16;  ///< Rays per packet.

  /// Returns the height of the first surface below `top` at each of up to kBatch positions (x, z); minus infinity if
  /// there is none down to `bottom`.
  [[nodiscard]] std::vector<double> heights(const std::vector<Eigen::Vector2d>& places, double top,
                                            double bottom) const;
  /// Returns true if no surface is within `length` of `from` in any of kBatch evenly spaced horizontal directions.
  [[nodiscard]] bool is_clear_around(const Eigen::Vector3d& from, double length) const;
  /// Returns the distance to the nearest surface in `direction`; null if it is beyond `length`.
  [[nodiscard]] std::optional<double> distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                               double length) const;

 private:
  struct Embree;
  explicit RayProbe(std::unique_ptr<Embree> embree);
  std::unique_ptr<Embree> embree_;
};

}  // namespace cyclorama::walkable
