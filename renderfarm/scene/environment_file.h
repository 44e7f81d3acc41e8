// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Maximum width. A wider map shows no more to a visitor and only takes memory: 4096 texels are 0.09 degrees each.
inline constexpr int kMaxEnvironmentWidthPx = 4096;

/// Returns the map at half its size, rounded up. Each texel is the mean of the texels that it replaces, weighted by
/// solid angle, so that the total light is unchanged. Reentrant.
[[nodiscard]] RadianceImage halved_environment(const RadianceImage& pixels);

/// Mean radiance over all directions, including the strength.
[[nodiscard]] Eigen::Vector3f mean_radiance(const EnvironmentMap& environment);

/// Reads an equirectangular picture and halves it until it is no wider than kMaxEnvironmentWidthPx; a note reports this.
/// Errors as read_radiance(), and kBadData if the picture is not twice as wide as high. Reentrant.
Result<RadianceImage> read_environment(const std::filesystem::path& file, const ImportLimits& limits,
                                       std::vector<std::string>* ret_notes);

}  // namespace cyclorama::scene
