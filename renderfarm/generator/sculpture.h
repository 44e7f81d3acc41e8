// SPDX-License-Identifier: Apache-2.0
/// Solids that are defined by a signed distance and have a grid wrapped around them; all figures consist of such
/// solids.
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

/// Returns a pose that is rotated by `heading` about the vertical: 0 faces +z, and positive headings turn to +x.
[[nodiscard]] Pose standing_at(const Vec3& position, float heading, float scale);

/// A solid in its own frame; in most of these frames, y points up and the front faces +z.
struct Sculpture {
  /// Signed distance, negative inside. The whole surface should be visible from the axis; hidden parts are bridged.
  std::function<float(const Vec3&)> distance;
  /// Height of folds and curls above the solid, at a point on its surface; may be empty. Leaves out details finer than
  /// the distance between vertices.
  std::function<float(const Vec3& p, float spacing_m)> relief;
  std::function<Vec3(const Vec3& p, float spacing_m)> colour;
  /// Ends of the grid's axis. The grid covers half a sphere of directions around each end, and full circles in between.
  Vec3 from = Vec3::Zero();
  Vec3 to = Vec3::UnitY();
  Vec3 front = Vec3::UnitZ();  ///< Perpendicular to the axis; the grid's seam is on the opposite side.
  float reach = 1.0f;          ///< Maximum distance of any part from the axis.
  float front_focus = 0.0f;    ///< 0 distributes columns evenly; values towards 1 gather them at the front.
  float ends = 1.0f;           ///< Rows at the two ends, relative to the rows along the axis.
  float girth = 1.0f;  ///< Circumference in the solid's unit; with the axis, it determines the share of triangles.
};

/// Returns the patch of a sculpture. See Patch::density for `density`.
[[nodiscard]] Patch wrapped(const Sculpture& sculpture, const Pose& pose, float density);

}  // namespace cyclorama::generator
