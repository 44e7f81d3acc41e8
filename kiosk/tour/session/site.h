// SPDX-License-Identifier: Apache-2.0
/// From the wire to navigation's own types.
#pragma once

#include <cstdint>
#include <string>

#include "common/wire/farm.pb.h"
#include "common/wire/museum.pb.h"
#include "kiosk/tour/navigation/guide.h"
#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama {

/// Where to walk. The start and the stops are moved into the walkable area where they lie outside; without a usable
/// area the visitor stands at the start, and `ret_warning` says so in one sentence for the operator. Precondition:
/// validate(scene) in common/wire/convert.h.
[[nodiscard]] Site site_of(const wire::SceneDescription& scene, std::string* ret_warning);

/// As it came, unchecked.
[[nodiscard]] PoseSeen pose_seen(std::uint64_t tracker, const wire::TrackedPose& pose);

}  // namespace cyclorama
