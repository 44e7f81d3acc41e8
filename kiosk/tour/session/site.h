// SPDX-License-Identifier: Apache-2.0
/// From the wire to navigation's own types.
#pragma once

#include <optional>

#include "common/geometry/rigid_transform.h"
#include "common/wire/farm.pb.h"
#include "common/wire/museum.pb.h"
#include "kiosk/tour/navigation/guide.h"

namespace cyclorama {

/// Where to walk. The start and the stops are moved into the walkable area where they lie outside; without a usable
/// area the visitor stands at the start, and `ret_warning` says so in one sentence for the operator. Precondition:
/// validate(scene) in common/wire/convert.h.
[[nodiscard]] Site site_of(const wire::SceneDescription& scene, std::string* ret_warning);

/// Any value that is not a rigid transform gives nothing.
[[nodiscard]] std::optional<RigidTransform<frame::Camera, frame::Tag>> tag_pose_of(const wire::TrackedPose& pose);

}  // namespace cyclorama
