// SPDX-License-Identifier: Apache-2.0
/// Settings for visitors, derived from the shape of geometry that comes without settings.
///
///   room    floor with walls around it and a ceiling above   the visitor stands where it is widest
///   site    ground to walk on, under the sky                 the visitor stands where it is widest
///   object  anything else: a bust, a vase                    the visitor stands before it (glTF's front is +z),
///                                                            walks around it, and sees it whole
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama::scene {

enum class SceneKind : std::uint8_t { kRoom, kSite, kObject };

struct FoundSettings {
  SceneKind kind = SceneKind::kObject;
  bool is_stage = false;  ///< The object is a room that lacks a wall, and is looked into from there.
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
  double eye_height_m = 1.6;
  double walking_scale = 1.0;
  std::vector<Eigen::Vector2d> walkable;  ///< (x, z) corners; contains the eye.
  double view_m = 1.0;                    ///< Typical distance that the eye sees.
  double ceiling_m = 0.0;                 ///< For rooms: height of the ceiling above the eye.
  double free_m = 0.0;                    ///< For rooms: distance to the nearest surface at eye height, at most 3 m.
};

/// Returns a viewpoint for a wall, which shows tangents from -0.5 to 0.3, in place of a camera outside of `bounds`. If
/// a level picture from the camera shows the scene, the camera is returned. Otherwise it is one that looks steeply up
/// or down, and the result is a level view of the whole scene from the camera's side.
[[nodiscard]] Viewpoint level_viewpoint(const Viewpoint& view, const Eigen::AlignedBox3d& bounds);

/// Derives the settings; if `eye` is given, it is kept and the other settings are derived for it. Precondition:
/// `bounds` is bounds_of(model) and not empty. Lengths are in metres, and y points up. Reentrant.
[[nodiscard]] FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds,
                                          const std::optional<Eigen::Vector3d>& eye);

}  // namespace cyclorama::scene
