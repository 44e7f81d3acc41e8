// SPDX-License-Identifier: Apache-2.0
/// A loaded and placed scene: metres, y up, ready for ray tracing.
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

namespace cyclorama::scene {

/// Light from all directions where no triangle hides it: a vertical gradient of linear radiance.
struct Sky {
  Eigen::Vector3f zenith = Eigen::Vector3f::Zero();
  Eigen::Vector3f horizon = Eigen::Vector3f::Zero();
  Eigen::Vector3f ground = Eigen::Vector3f::Zero();
};

/// Mapping from exposed light to display light; see renderfarm/render/tone.h.
enum class ToneCurve { kShoulder, kLinear, kFilmic };

inline constexpr int kUsualBounces = 4;
inline constexpr int kMaxSceneBounces = 64;

struct SceneTourStop {
  std::string title;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
};

/// Everything that a museum may know about a scene, without its geometry. Scene frame.
struct SceneInfo {
  std::string title;
  std::string credits;
  Eigen::Vector3d start_eye = Eigen::Vector3d::Zero();
  double start_heading_rad = 0.0;
  double eye_height_m = 1.6;
  std::vector<Eigen::Vector2d> walkable;  ///< (x, z) corners; at least three.
  /// Corners of each hole; inside `walkable` and not walkable.
  std::vector<std::vector<Eigen::Vector2d>> walkable_holes;
  double walking_scale = 1.0;
  std::vector<SceneTourStop> stops;
  std::vector<std::string> lamp_groups;  ///< Names of the groups 1 and up (lamp_groups.h).
};

/// A value, which is large and should be moved. Model's invariants hold; instances and lights are in the Scene frame,
/// in metres.
struct Scene {
  SceneInfo info;
  Model model;
  Sky sky;
  std::shared_ptr<const EnvironmentMap> environment;  ///< Replaces the sky. May be null.
  /// Radiance from all directions that surfaces receive in addition; casts no shadows.
  Eigen::Vector3f ambient = Eigen::Vector3f::Zero();
  /// Lamp at the visitor's eye, in candela; zero for none. It lights what the eye sees, without indirect light.
  Eigen::Vector3f eye_lamp = Eigen::Vector3f::Zero();
  double exposure = 1.0;  ///< Factor by which radiance is multiplied before tone mapping.
  ToneCurve tone = ToneCurve::kShoulder;
  int bounces = kUsualBounces;  ///< RenderQuality::bounces of this scene's reference picture.
  Eigen::AlignedBox3d bounds;

  [[nodiscard]] std::uint64_t triangles_stored() const;
  [[nodiscard]] std::uint64_t triangles_seen() const;  ///< Counts each instance.
  [[nodiscard]] std::size_t memory_bytes() const;      ///< Geometry and textures, without the BVH.
};

/// Called occasionally with a fraction in [0, 1]; may be null.
using LoadProgress = std::function<void(double)>;

/// Loads a scene package (a folder with scene.toml, or that file) or one geometry file (.glb .gltf .ply .obj .las .e57
/// .spz); for a geometry file, find_settings() derives the settings. The format is detected by content, then by name.
/// Errors: those of the importers and of Config; kNotFound if `path` does not exist; kSystem also if memory runs out.
/// Reentrant.
Result<Scene> load_scene(const std::filesystem::path& path, const ImportLimits& limits, const LoadProgress& progress);

}  // namespace cyclorama::scene
