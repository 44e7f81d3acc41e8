// SPDX-License-Identifier: Apache-2.0
/// Conversion between wire messages and the project's types; the only place where wire input is checked.
#pragma once

#include <Eigen/Core>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/wire/farm.pb.h"
#include "common/wire/view.pb.h"

namespace cyclorama {

[[nodiscard]] Eigen::Vector3d from_wire(const wire::Vector3& v);
void to_wire(const Eigen::Vector3d& v, wire::Vector3* ret_v);

/// Accepts one eye or both. Errors: those of Projection::validate(); kInvalidArgument for an unknown projection, and
/// for two pictures that are not divided at a multiple of kCutPx.
Result<Projection> from_wire(const wire::Panorama& p);
/// Converts a picture for one eye. Precondition: it is not equirectangular, since such a picture is never requested
/// from a farm.
void to_wire(const PictureShape& shape, wire::Panorama* ret_p);
/// Converts a picture for one eye or both. Preconditions: it is not equirectangular; one eye is at the sweet spot, or
/// both are beside it.
void to_wire(const Projection& picture, wire::Panorama* ret_p);

/// Checks everything in a view that a node or a display relies on. Errors: kInvalidArgument, which names the field.
Status validate(const wire::View& view);
/// Checks that a tile lies inside its picture of the given size and starts at a multiple of 16 pixels. Errors:
/// kInvalidArgument.
Status validate(const wire::Tile& tile, int width_px, int height_px);
/// Checks that a scene can be walked in: finite poses, at least three corners, and a positive scale. Errors:
/// kInvalidArgument, which names the field.
Status validate(const wire::SceneDescription& scene);

}  // namespace cyclorama
