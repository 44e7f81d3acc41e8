// SPDX-License-Identifier: Apache-2.0
/// Paths of the eye through a scene while its costs are recorded.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Position and heading of the eye in one frame. Scene frame.
struct EyePose {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
};

struct EyePathOptions {
  int frames = 120;
  double step_rad = 0.0523599;  ///< 3 degrees: a full circle in 120 frames. Maximum rotation of a walk in one frame.
  double step_m = 0.06;         ///< Step of a walk: 1.2 m/s at 20 frames a second.
  std::optional<double> radius_m{};
};

/// An orbit around a point ahead of the scene's start, facing it. Default radius: from outside the scene's bounds, the
/// distance to their centre; from inside, a quarter of the hall's shorter side.
[[nodiscard]] std::vector<EyePose> orbit(const scene::SceneInfo& info, const Eigen::AlignedBox3d& bounds,
                                         const EyePathOptions& options);

/// A walk from the scene's start to each of its stops in turn, and then from the start again. In a scene without stops
/// the eye stands still.
[[nodiscard]] std::vector<EyePose> walk(const scene::SceneInfo& info, const EyePathOptions& options);

}  // namespace cyclorama
