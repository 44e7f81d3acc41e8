// SPDX-License-Identifier: Apache-2.0
/// Merges the models of several files into one, in metres with y up.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns the transform from a file's axes and unit to metres with y up.
[[nodiscard]] Eigen::Affine3d T_part_file(double unit_m, bool z_up);

/// Moves `part` into `whole`, once for each placement: meshes are stored once; instances, lights and views are
/// repeated. Intensities in candela are assumed to refer to the file's unit of length, so they are multiplied by the
/// square of `unit_m`.
void add_part(Model part, double unit_m, const std::vector<Eigen::Affine3d>& T_whole_file, Model* whole);

/// Enlarges each lamp that is inside a small emissive mesh, such as a bulb in a glass globe, until the lamp encloses
/// the mesh; otherwise the mesh would block its light. `model` is in metres.
void free_lamps(Model* model);

/// Returns the bounds of the corners of all triangles and of the splats (splat_cloud.h), in the model's frame; empty if
/// there are none.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const Model& model);

}  // namespace cyclorama::scene
