// SPDX-License-Identifier: Apache-2.0
/// A solid, defined by a signed distance, with a grid wrapped around it; all figures are made of these.
#pragma once

#include <functional>

#include "renderfarm/generator/surface.h"
#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

/// Pose of a sculpture: p_room = position + scale * rotation * p.
struct Pose {
  Vec3 position = Vec3::Zero();
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  float scale = 1.0f;

  [[nodiscard]] Vec3 to_room(const Vec3& p) const { return position + scale * (rotation * p); }
};

/// Pose rotated by `heading` about the vertical: 0 faces +z, positive turns to +x.
[[nodiscard]] Pose standing_at(const Vec3& position, float heading, float scale);

/// A solid in its own frame; for most of them y is up and the face along +z.
struct Sculpture {
  /// Negative inside. The solid should be wholly visible from its axis; hidden parts are bridged.
  std::function<float(const Vec3&)> distance;
  /// Height of folds and curls beyond the solid at a point on it; may be empty. Leaves out detail finer than the
  /// distance between vertices.
  std::function<float(const Vec3& p, float spacing_m)> relief;
  std::function<Vec3(const Vec3& p, float spacing_m)> colour;
  /// The grid's axis: half a sphere of directions at each end, and full circles in between.
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::UnitY();
  Vec3 front = Vec3::UnitZ();  ///< Perpendicular to the axis; the seam is opposite.
  float reach = 1.0f;          ///< Maximum distance of any part from the axis.
  float front_focus = 0.0f;    ///< 0 distributes columns evenly; values towards 1 gather them at the front.
  float ends = 1.0f;           ///< Rows for the two ends, relative to those along the axis.
  float girth = 1.0f;          ///< Circumference in its own unit; with the axis it determines the share of triangles.
};

/// `density` as in Patch.
[[nodiscard]] Patch wrapped(const Sculpture& sculpture, const Pose& pose, float density);

}  // namespace cyclorama::generator
