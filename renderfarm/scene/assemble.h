// SPDX-License-Identifier: Apache-2.0
/// Merges the models of several files into one, in metres with y up.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Transform from a file's own axes and unit to metres with y up.
[[nodiscard]] Eigen::Affine3d T_part_file(double unit_m, bool z_up);

/// Moves `part` into `whole`, once for each placement: meshes are stored once; instances, lights and views are
/// repeated.
/// Intensities in candela are taken to hold in the file's own unit, so they are multiplied by the square of `unit_m`.
void add_part(Model part, double unit_m, const std::vector<Eigen::Affine3d>& T_whole_file, Model* whole);

/// Enlarges each lamp that lies inside a small emissive mesh, such as a bulb in its globe, until it encloses that mesh;
/// otherwise the globe would block its light. `model` is in metres.
void free_lamps(Model* model);

/// Bounds of the corners of all triangles and of the splats (splat_cloud.h), in the model's frame; empty if there are
/// none.
[[nodiscard]] Eigen::AlignedBox3d bounds_of(const Model& model);

}  // namespace cyclorama::scene
