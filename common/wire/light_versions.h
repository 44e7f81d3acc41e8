// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace cyclorama::wire {

/// Number of newest versions of a scene's light that a node keeps, so that frames in flight and pictures at rest keep
/// their version when a new one comes.
inline constexpr std::size_t kKeptLightVersions = 2;

}  // namespace cyclorama::wire
