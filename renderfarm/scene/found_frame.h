// SPDX-License-Identifier: Apache-2.0
/// Unit and position of a geometry file that comes without a scene package.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// States which parts of a file's frame its format prescribes.
enum class StatedFrame : std::uint8_t {
  kNothing,     ///< Neither the unit nor the axis that points up.
  kUp,          ///< y points up. Metres are prescribed, but many files are in another unit.
  kUpAndMetres  ///< Surveyors' formats, turned when they are read.
};

struct FoundFrame {
  double unit_m = 1.0;
  Eigen::Affine3d T_scene_file = Eigen::Affine3d::Identity();  ///< Includes the unit.
  std::vector<std::string> notes;  ///< The assumptions that were made, for users who know better.
};

/// Derives unit and position from the geometry. glTF prescribes metres and the other formats state no unit, but files
/// of all formats exist in millimetres and centimetres. The unit follows from the size of rooms; a file without rooms
/// is an object, which is shown whole whatever its unit. A file that stands on z = 0 and not on y = 0 has z up. A small
/// flat object that lies on the ground, such as a coin or a map, is raised upright to face the visitor, unless the file
/// has cameras. Reentrant; `file` is unchanged on return.
[[nodiscard]] FoundFrame find_frame(Model* file, StatedFrame stated);

}  // namespace cyclorama::scene
