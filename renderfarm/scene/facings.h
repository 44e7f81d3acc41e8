// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Twice the area of a model's triangles, by the axis that they face.
struct Facings {
  Eigen::Vector3d both = Eigen::Vector3d::Zero();  ///< Area that faces either end of the axis.
  /// Area that faces the axis's positive end minus the area that faces its negative end.
  Eigen::Vector3d surplus = Eigen::Vector3d::Zero();

  /// Returns true if the model is open and shows its back to a viewer on the axis's positive side. The surplus of a
  /// closed body is 0.
  [[nodiscard]] bool shows_back(Eigen::Index axis) const { return surplus[axis] < -0.5 * both[axis]; }

  static constexpr int kSides = 8;
  /// Area of the fronts as seen by a far viewer on each side: that of +z first, then every 45 degrees towards +x.
  std::array<double, kSides> seen_from{};
};

/// Computes the facings of `model`, from a sample of the triangles if a mesh is large. Reentrant.
[[nodiscard]] Facings facings_of(const Model& model);

}  // namespace cyclorama::scene
