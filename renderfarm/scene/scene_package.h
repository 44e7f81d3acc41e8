// SPDX-License-Identifier: Apache-2.0
/// scene.toml, read and checked before any geometry. docs/reference/scene-package.md lists every key.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::scene {

/// One geometry file and its placements; the geometry is stored once.
struct PackageGeometry {
  std::filesystem::path file;
  double unit_m = 1.0;
  bool z_up = false;
  /// Placements; at least one. The part frame is that of the file, in metres with y up.
  std::vector<Eigen::Affine3d> T_scene_part;
};

/// A picture of the light from all directions.
struct PackageEnvironment {
  std::filesystem::path file;
  float strength = 1.0f;
  float rotation_rad = 0.0f;  ///< Positive to the right.
};

/// Content of scene.toml, in the Scene frame and metres. Absent values are derived from the geometry.
struct ScenePackage {
  std::string title;
  std::string credits;
  bool repair = false;  ///< What is broken in the geometry is mended, as far as that is safe: see defects.h.
  std::optional<double> exposure;
  ToneCurve tone = ToneCurve::kShoulder;
  int bounces = kUsualBounces;
  std::optional<Eigen::Vector3d> start_eye;
  std::optional<double> start_heading_rad;
  std::optional<double> eye_height_m;
  std::optional<double> walking_scale;
  std::vector<Eigen::Vector2d> walkable;
  std::vector<std::vector<Eigen::Vector2d>> walkable_holes;  ///< Empty unless `walkable` is given.
  std::optional<Sky> sky;
  std::optional<PackageEnvironment> environment;  ///< Never set together with `sky`.
  std::optional<Eigen::Vector3f> ambient;
  std::optional<Eigen::Vector3f> eye_lamp;
  std::vector<Light> lamps;
  std::vector<std::string> lamp_groups;   ///< Names of the groups 1 and up (lamp_groups.h).
  std::vector<PackageGeometry> geometry;  ///< At least one.
  std::vector<SceneTourStop> stops;
};

/// Parses `text`; `name` stands for the file in errors, and geometry is searched only in `folder`. Errors: kBadData, in
/// the form "scene.toml:7: ...". Reentrant.
Result<ScenePackage> parse_scene_package(std::string_view text, std::string name, const std::filesystem::path& folder);

}  // namespace cyclorama::scene
