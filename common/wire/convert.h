// SPDX-License-Identifier: Apache-2.0
/// Between wire messages and the house's types; what comes from the wire is checked here, once.
#pragma once

#include <Eigen/Core>

#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/wire/farm.pb.h"
#include "common/wire/view.pb.h"

namespace cyclorama {

[[nodiscard]] Eigen::Vector3d from_wire(const wire::Vector3& v);
void to_wire(const Eigen::Vector3d& v, wire::Vector3* ret_v);

/// For one eye, or for both. kInvalidArgument  as Projection::validate(), a projection that this program does not know,
/// and two pictures that are not cut from one another at a multiple of kCutPx.
Result<Projection> from_wire(const wire::Panorama& p);
/// For one eye. Precondition: it is not equirectangular, which nobody asks a farm for.
void to_wire(const PictureShape& shape, wire::Panorama* ret_p);
/// Precondition: the same; one eye in the sweet spot, or both beside it in one picture.
void to_wire(const Projection& picture, wire::Panorama* ret_p);

/// Everything in a view that a node or a display relies on. kInvalidArgument names the field.
Status validate(const wire::View& view);
/// That a tile lies inside its picture, of that size, and starts on a 16-pixel cut. kInvalidArgument.
Status validate(const wire::Tile& tile, int width_px, int height_px);
/// That a scene can be walked in: finite poses, three corners or more, a positive scale. kInvalidArgument names the
/// field.
Status validate(const wire::SceneDescription& scene);

}  // namespace cyclorama
