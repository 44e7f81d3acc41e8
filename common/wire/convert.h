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

/// kInvalidArgument  as validate(), and a projection that this program does not know.
Result<PictureShape> from_wire(const wire::Panorama& p);
/// Precondition: it is not equirectangular, which nobody asks a farm for.
void to_wire(const PictureShape& shape, wire::Panorama* ret_p);

/// Everything in a view that a node or a display relies on. kInvalidArgument names the field.
Status validate(const wire::View& view);
/// That a tile lies inside its picture and starts on a 16-pixel cut. kInvalidArgument.
Status validate(const wire::Tile& tile, const PictureShape& picture);
/// That a scene can be walked in: finite poses, three corners or more, a positive scale. kInvalidArgument names the field.
Status validate(const wire::SceneDescription& scene);

}  // namespace cyclorama
