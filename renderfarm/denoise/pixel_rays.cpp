// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/pixel_rays.h"

#include <cmath>
#include <utility>
#include <vector>

namespace cyclorama {

PixelRays panorama_rays(const Panorama& panorama, double heading_rad, const PixelRect& rect) {
  PixelRays rays{RadianceImage(rect.width, rect.height), panorama.radians_per_px()};
  std::vector<std::pair<float, float>> columns;
  for (int x = 0; x < rect.width; ++x) {
    const double azimuth = panorama.azimuth_at(rect.x + x + 0.5) + heading_rad;
    columns.emplace_back(static_cast<float>(std::sin(azimuth)), static_cast<float>(-std::cos(azimuth)));
  }
  float* out = rays.directions.data().data();
  for (int y = 0; y < rect.height; ++y) {
    const auto t = static_cast<float>(panorama.tan_elevation_at(rect.y + y + 0.5));
    const float scale = 1.0f / std::sqrt(1.0f + t * t);
    for (const auto& [east, south] : columns) {
      *out++ = scale * east;
      *out++ = scale * t;
      *out++ = scale * south;
    }
  }
  return rays;
}

}  // namespace cyclorama
