// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Returns the share of the horizontal directions in which an eye sees the back of a triangle, among those in which it
/// sees anything: most of them inside of a solid thing. Exact, unlike a SpaceGrid, whose cells may hold both sides of a
/// thin shell. Tests every triangle, so it returns nothing for models of more than half a million. Reentrant.
[[nodiscard]] std::optional<double> back_face_share(const Model& model, const Eigen::Vector3d& eye);

}  // namespace cyclorama::scene
