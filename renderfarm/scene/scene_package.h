// SPDX-License-Identifier: Apache-2.0
/// scene.toml as read, before any geometry is: what a scene package says, checked.
/// docs/reference/scene-package.md lists every key.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// One geometry file and where it stands; stored once, however often it stands.
struct PackageGeometry {
  std::filesystem::path file;
  double unit_m = 1.0;
  bool z_up = false;
  std::vector<Eigen::Affine3d> T_scene_part;  ///< At least one. Part: the file's model in metres, y up.
};

/// A picture of the light from all around.
struct PackageEnvironment {
  std::filesystem::path file;
  float strength = 1.0f;
  float rotation_rad = 0.0f;  ///< To the right.
};

/// What is absent is found from the geometry. Scene frame, metres.
struct ScenePackage {
  std::string title;
  std::string credits;
  std::optional<double> exposure;
  ToneCurve tone = ToneCurve::kShoulder;
  int bounces = kUsualBounces;
  std::optional<Eigen::Vector3d> start_eye;
  std::optional<double> start_heading_rad;
  std::optional<double> eye_height_m;
  std::optional<double> walking_scale;
  std::vector<Eigen::Vector2d> walkable;
  std::vector<std::vector<Eigen::Vector2d>> walkable_holes;  ///< Only beside `walkable`.
  std::optional<Sky> sky;
  std::optional<PackageEnvironment> environment;  ///< Not beside a sky.
  std::optional<Eigen::Vector3f> ambient;
  std::optional<Eigen::Vector3f> eye_lamp;
  std::vector<Light> lamps;
  std::vector<PackageGeometry> geometry;  ///< At least one.
  std::vector<SceneTourStop> stops;
};

/// `name` stands for the file in errors; geometry is looked for in `folder` and nowhere else.
/// kBadData  "scene.toml:7: ...". Reentrant.
Result<ScenePackage> parse_scene_package(std::string_view text, std::string name, const std::filesystem::path& folder);

}  // namespace cyclorama
