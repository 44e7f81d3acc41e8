// SPDX-License-Identifier: Apache-2.0
/// A solid, modelled as a signed distance, with a grid drawn over it: what all figures are made of.
#pragma once

#include <functional>

#include "renderfarm/generator/surface.h"
#include "renderfarm/generator/vec.h"

namespace cyclorama::grotto {

/// Where a sculpture stands: p_room = position + scale * rotation * p.
struct Pose {
  Vec3 position = Vec3::Zero();
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  float scale = 1.0f;

  [[nodiscard]] Vec3 to_room(const Vec3& p) const { return position + scale * (rotation * p); }
};

/// Turned by `heading` about the vertical: 0 looks along +z, positive to +x.
[[nodiscard]] Pose standing_at(const Vec3& position, float heading, float scale);

/// A solid in its own frame (y up, face along +z, for most of them).
struct Sculpture {
  /// Negative inside. The solid should be seen whole from its axis; what another part hides there is bridged.
  std::function<float(const Vec3&)> distance;
  /// How far the chisel goes beyond the solid at a place on it, for folds and curls; may be empty. What is finer than
  /// the distance between vertices is to be left out.
  std::function<float(const Vec3& p, float spacing_m)> relief;
  std::function<Vec3(const Vec3& p, float spacing_m)> colour;
  /// The grid's axis: half a sphere of directions at each end, and around in between.
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::UnitY();
  Vec3 front = Vec3::UnitZ();  ///< Across the axis; the seam is opposite.
  float reach = 1.0f;          ///< No part is farther from the axis.
  float front_focus = 0.0f;    ///< 0 spreads columns evenly, towards 1 gathers them at the front.
  float ends = 1.0f;           ///< Rows for the two ends, relative to those along the axis.
  float girth = 1.0f;          ///< Length round it, in its own unit: with the axis it decides the share of triangles.
};

/// `density` as in Patch.
[[nodiscard]] Patch wrapped(const Sculpture& sculpture, const Pose& pose, float density);

}  // namespace cyclorama::grotto
