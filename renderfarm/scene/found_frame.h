// SPDX-License-Identifier: Apache-2.0
/// Unit and position of a geometry file that comes without a scene package.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

struct FoundFrame {
  double unit_m = 1.0;
  Eigen::Affine3d T_scene_file = Eigen::Affine3d::Identity();  ///< Unit included.
  std::vector<std::string> notes;  ///< The assumptions, for people who have better information.
};

/// glTF is in metres by its standard and the other formats state no unit, but files of all kinds exist in millimetres
/// and centimetres. A unit is taken from the size of rooms; where there are none, an object is shown whole whatever its
/// unit. A small flat thing that lies on its back, such as a coin or a map, is stood up to face the visitor, unless the
/// file has cameras. Reentrant; `file` is unchanged on return.
[[nodiscard]] FoundFrame find_frame(Model* file);

}  // namespace cyclorama::scene
