// SPDX-License-Identifier: Apache-2.0
/// Models of several files into one, in metres and y up.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama {

/// From a file's own axes and unit to metres and y up.
[[nodiscard]] Eigen::Affine3d T_part_file(double unit_m, bool z_up);

/// Moves `part` into `whole`, once for each placement: meshes are stored once, instances, lights and views are repeated.
/// The candelas of a file are taken as what its author saw in the file's own unit, so they shrink with its square.
void add_part(Model part, double unit_m, const std::vector<Eigen::Affine3d>& T_whole_file, Model* whole);

/// A lamp that stands inside of something that glows, as a bulb in its globe, shines from around it: else the globe would
/// keep all its light. `model` is in metres.
void free_lamps(Model* model);

/// Of the corners of all triangles, in the model's frame; empty when there are none.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const Model& model);

}  // namespace cyclorama
