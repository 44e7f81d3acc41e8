// SPDX-License-Identifier: Apache-2.0
/// Settings for geometry that says nothing about its visitors: found by looking at it.
///
///   room    a place to stand with walls around and a ceiling above   the visitor stands where it is widest
///   site    ground to walk on, under the sky                         the same
///   object  anything else: a bust, a vase                            the visitor stands before it (glTF's front is
///   +z),
///                                                                    walks around it, and sees it whole
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama {

enum class SceneKind : std::uint8_t { kRoom, kSite, kObject };

struct FoundSettings {
  SceneKind kind = SceneKind::kObject;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  double eye_height_m = 1.6;
  double walking_scale = 1.0;
  std::vector<Eigen::Vector2d> walkable;  ///< (x, z); the eye is inside.
  double view_m = 1.0;                    ///< How far the eye sees, as a rule.
  double ceiling_m = 0.0;                 ///< Rooms: above the eye.
  double free_m = 0.0;                    ///< Rooms: nothing is nearer at eye height.
};

/// `eye`, when somebody has chosen one, is kept, and the rest found around it. Precondition: `bounds` is
/// bounds_of(model), not empty. In metres, y up. Reentrant.
[[nodiscard]] FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds,
                                          const std::optional<Eigen::Vector3d>& eye);

/// Gives light to a scene that has none: the sky and a sun-like lamp outside and around objects, one lamp at the
/// eye and one above in rooms. What shines by itself does not count: it lights nothing else.
void add_light(const FoundSettings& found, Scene* scene);

/// The exposure at which what the lamps fall on around the eye is of middle brightness: files mean anything from one
/// candela to a hundred thousand by the same light. The environment counts as if all of it were seen. 1 where neither
/// gives light. Shadows are not looked at.
[[nodiscard]] double find_exposure(const FoundSettings& found, const Scene& scene);

}  // namespace cyclorama
