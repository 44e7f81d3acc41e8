// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Rays through a scene's geometry, for whoever asks what is where, not what it looks like: the exact answers that a
/// SpaceGrid gives coarsely. What blends (light shafts, fog, panes that are drawn so) stops nobody and is left out.
///
/// Copies no triangles: borrows the scene, which must not change. Reentrant.
class RayProbe {
 public:
  /// `near` is where rays are most exact: all is placed around it. kSystem  Embree gave up, as out of memory.
  static Result<RayProbe> build(const Scene& scene, const Eigen::Vector3d& near);
  RayProbe(RayProbe&&) noexcept;
  RayProbe& operator=(RayProbe&&) noexcept;
  ~RayProbe();

  static constexpr int kBatch = 16;  ///< Rays that are traced together.

  /// The height of the first surface below `top` at each of up to kBatch places (x, z); minus infinity: none down to
  /// `bottom`.
  [[nodiscard]] std::vector<double> heights(const std::vector<Eigen::Vector2d>& places, double top,
                                            double bottom) const;
  /// Does nothing lie within `length` of `from` in any of kBatch level directions, evenly all around?
  [[nodiscard]] bool is_clear_around(const Eigen::Vector3d& from, double length) const;
  /// How far it is to what lies that way; nothing: beyond `length`.
  [[nodiscard]] std::optional<double> distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                               double length) const;

 private:
  struct Embree;
  explicit RayProbe(std::unique_ptr<Embree> embree);
  std::unique_ptr<Embree> embree_;
};

}  // namespace cyclorama
