// SPDX-License-Identifier: Apache-2.0
/// A scene, loaded and placed: metres, y up, ready to be ray traced.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Light from everywhere that no triangle hides: a vertical gradient of radiance, linear.
struct Sky {
  Eigen::Vector3f zenith = Eigen::Vector3f::Zero();
  Eigen::Vector3f horizon = Eigen::Vector3f::Zero();
  Eigen::Vector3f ground = Eigen::Vector3f::Zero();
};

/// How exposed light becomes display light: renderfarm/render/tone.h.
enum class ToneCurve { kShoulder, kLinear, kFilmic };

inline constexpr int kUsualBounces = 4;
inline constexpr int kMostSceneBounces = 64;

struct SceneTourStop {
  std::string title;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
};

/// All that a museum may know of a scene, and nothing of its geometry. Scene frame.
struct SceneInfo {
  std::string title;
  std::string credits;
  Eigen::Vector3d start_eye = Eigen::Vector3d::Zero();
  double start_heading_rad = 0.0;
  double eye_height_m = 1.6;
  std::vector<Eigen::Vector2d> walkable;                     ///< (x, z) corners; at least three.
  std::vector<std::vector<Eigen::Vector2d>> walkable_holes;  ///< Corners each; in it, and not walkable.
  double walking_scale = 1.0;
  std::vector<SceneTourStop> stops;
};

/// A value (large: move it). Invariants of Model hold; instances and lights are in the Scene frame, in metres.
struct Scene {
  SceneInfo info;
  Model model;
  Sky sky;
  std::shared_ptr<const EnvironmentMap> environment;  ///< Takes the place of the sky. May be null.
  Eigen::Vector3f ambient = Eigen::Vector3f::Zero();  ///< Radiance added to what surfaces receive, unshadowed.
  /// A lamp that the visitor carries at the eye, candela; zero is none. Scenes without any light get one.
  Eigen::Vector3f eye_lamp = Eigen::Vector3f::Zero();
  double exposure = 1.0;  ///< Radiance is multiplied by this before it becomes a code value.
  ToneCurve tone = ToneCurve::kShoulder;
  int bounces = kUsualBounces;  ///< Of the light in this scene's reference; RenderQuality::bounces.
  Eigen::AlignedBox3d bounds;

  [[nodiscard]] std::uint64_t triangles_stored() const;
  [[nodiscard]] std::uint64_t triangles_seen() const;  ///< With instances counted.
  [[nodiscard]] std::size_t memory_bytes() const;      ///< Of geometry and textures, without the BVH.
};

/// Called now and then with a fraction in [0, 1]; may be null.
using LoadProgress = std::function<void(double)>;

/// Loads a scene package (a folder with scene.toml, or that file) or one geometry file (.glb .gltf .ply .obj), for
/// which sensible settings are found from its bounds. The format is told by content, then by name.
/// Errors as the importers' and Config's; kNotFound when `path` does not exist; kSystem also when memory runs out.
/// Reentrant.
Result<Scene> load_scene(const std::filesystem::path& path, const ImportLimits& limits, const LoadProgress& progress);

}  // namespace cyclorama
