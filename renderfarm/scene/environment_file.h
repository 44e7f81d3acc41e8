// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Wider maps show nothing more to a visitor and only take memory: 4096 texels are 0.09 degrees each.
inline constexpr int kWidestEnvironmentPx = 4096;

/// Half the size, rounded up; each texel is the mean over the solid angle of those that it stands for, so that the map
/// gives as much light as before. Reentrant.
[[nodiscard]] RadianceImage halved_environment(const RadianceImage& pixels);

/// Radiance averaged over all directions, strength included.
[[nodiscard]] Eigen::Vector3f mean_radiance(const EnvironmentMap& environment);

/// Reads an equirectangular picture, halved until it is not wider than kWidestEnvironmentPx, which is then noted.
/// Errors as read_radiance()'s; kBadData also when it is not twice as wide as high. Reentrant.
Result<RadianceImage> read_environment(const std::filesystem::path& file, const ImportLimits& limits,
                                       std::vector<std::string>* ret_notes);

}  // namespace cyclorama
