// SPDX-License-Identifier: Apache-2.0
/// Converts wire messages to navigation's own types.
#pragma once

#include <cstdint>
#include <string>

#include "common/wire/farm.pb.h"
#include "common/wire/museum.pb.h"
#include "kiosk/tour/navigation/guide.h"
#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama::tour {

/// Returns the site to walk in. Moves the start and the stops into the walkable area if they lie outside. Without a
/// usable area the visitor stays at the start, and `ret_warning` gets one sentence about it for the operator.
/// Precondition: validate(scene) in common/wire/convert.h.
[[nodiscard]] Site site_of(const wire::SceneDescription& scene, std::string* ret_warning);

/// Converts the pose without checking it.
[[nodiscard]] PoseSeen pose_seen(std::uint64_t tracker, const wire::TrackedPose& pose);

}  // namespace cyclorama::tour
