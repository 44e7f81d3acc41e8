// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/pixel_rays.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/picture_place.h"

namespace cyclorama::denoise {
namespace {

double radians_per_px(const PictureShape& shape) {
  const PixelScale scale = pixel_scale(shape);
  if (!std::holds_alternative<Perspective>(shape)) return 1.0 / scale.u_per_across;
  // In a perspective, coordinates are tangents; at the centre, the angle per unit is the squared cosine.
  const PicturePlace middle = scale.place_at({0.5 * width_px(shape), 0.5 * height_px(shape)});
  return 1.0 / (1.0 + std::pow(middle.across, 2) + std::pow(middle.up, 2)) / scale.u_per_across;
}

/// Returns the directions of pixel centres. `seen` returns the direction of a pixel, or nothing if it has none.
PixelRays rays_of(const PictureShape& shape, double heading_rad, const PixelRect& rect, const auto& seen) {
  const Eigen::Vector3d axis = direction_of(shape, {});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(-heading_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  PixelRays rays{RadianceImage(rect.width, rect.height), radians_per_px(shape)};
  float* out = rays.directions.data().data();
  for (int y = 0; y < rect.height; ++y) {
    for (int x = 0; x < rect.width; ++x) {
      const Eigen::Vector3d direction = seen(PanoramaPixel{rect.x + x + 0.5, rect.y + y + 0.5}).value_or(axis);
      const Eigen::Vector3f turned = (turn * direction.normalized()).template cast<float>();
      out = std::copy_n(turned.data(), 3, out);
    }
  }
  return rays;
}

}  // namespace

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

PixelRays picture_rays(const PictureShape& shape, double heading_rad, const PixelRect& rect) {
  if (const auto* panorama = std::get_if<Panorama>(&shape)) return panorama_rays(*panorama, heading_rad, rect);
  return rays_of(shape, heading_rad, rect, [&](const PanoramaPixel& p) { return direction_at(shape, p); });
}

PixelRays picture_rays(const Projection& picture, double heading_rad, const PixelRect& rect) {
  if (picture.viewing == Viewing{}) return picture_rays(picture.shape, heading_rad, rect);
  return rays_of(picture.shape, heading_rad, rect, [&](const PanoramaPixel& p) -> std::optional<Eigen::Vector3d> {
    const std::optional<EyeRay> ray = picture.ray_at(p);
    return ray ? std::optional(ray->direction) : std::nullopt;
  });
}

}  // namespace cyclorama::denoise
