// SPDX-License-Identifier: Apache-2.0
/// The ways that an eye goes through a scene while its costs are recorded.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Where the eye is in one frame, and where it looks. Scene frame.
struct EyePose {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double heading_rad = 0.0;
};

struct EyePathOptions {
  int frames = 120;
  double step_rad = 0.0523599;  ///< 3 degrees: a full circle in 120 frames. The most that a walk turns in one frame.
  double step_m = 0.06;         ///< Of a walk: 1.2 m/s at 20 frames a second.
  std::optional<double> radius_m{};
};

/// Around a point ahead of the scene's start, looking at it. The radius, if left out: from outside of the scene's
/// bounds as far as their middle, from inside a quarter of the hall's shorter side.
[[nodiscard]] std::vector<EyePose> orbit(const SceneInfo& info, const Eigen::AlignedBox3d& bounds,
                                         const EyePathOptions& options);

/// From the scene's start to each of its stops in turn, and again from the start; a scene without stops is left as it
/// stands.
[[nodiscard]] std::vector<EyePose> walk(const SceneInfo& info, const EyePathOptions& options);

}  // namespace cyclorama
