// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace cyclorama::wire {

/// A node keeps this many versions of a scene's light, the newest, so that frames in flight and pictures at rest keep
/// theirs when a new one comes.
inline constexpr std::size_t kKeptLightVersions = 2;

}  // namespace cyclorama::wire
