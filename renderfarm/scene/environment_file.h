// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Maximum width, at which a texel spans 0.09 degrees. Visitors see no more detail in a wider map, which only takes
/// memory.
inline constexpr int kMaxEnvironmentWidthPx = 4096;

/// Returns the map at half its size, rounded up. Each texel is the mean of the texels that it replaces, weighted by
/// solid angle, so that the total light is unchanged. Reentrant.
[[nodiscard]] RadianceImage halved_environment(const RadianceImage& pixels);

/// Returns the mean radiance over all directions, including the strength.
[[nodiscard]] Eigen::Vector3f mean_radiance(const EnvironmentMap& environment);

/// Reads an equirectangular picture and halves it until it is at most kMaxEnvironmentWidthPx wide; a note reports this.
/// Errors: those of read_radiance(), and kBadData if the picture is not twice as wide as high. Reentrant.
Result<RadianceImage> read_environment(const std::filesystem::path& file, const ImportLimits& limits,
                                       std::vector<std::string>* ret_notes);

}  // namespace cyclorama::scene
