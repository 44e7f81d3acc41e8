// SPDX-License-Identifier: Apache-2.0
/// Films of a scene whose true picture is known: spheres on a chequered floor before a wall, lit by a lamp with a soft
/// shadow and a uniform sky. Its noise has a known distribution: half of each sample's light is exponentially
/// distributed, and one sample in `firefly_every` carries that many times the mean of a tenth of it.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>

#include "renderfarm/denoise/pixel_rays.h"

namespace cyclorama {

struct AnalyticScene {
  Panorama panorama{192, 96, 1.2, 0.3, -0.3};
  Eigen::Vector3d eye{0.0, 1.5, 0.0};
  double heading_rad = 0.0;
  double firefly_every = 2000.0;  ///< 0 for none.
  double noise = 1.0;             ///< 0 leaves only the noise at edges within pixels.
  bool stratified = false;  ///< Samples of a pixel are stratified, so their mean errs less than their spread suggests.

  struct Hit {
    Eigen::Vector3f albedo = Eigen::Vector3f::Ones();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    Eigen::Vector3f light = Eigen::Vector3f::Zero();  ///< Mean radiance over albedo.
    float distance = 0.0f;
    bool noisy = false;
  };

  [[nodiscard]] Hit intersect(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d d = direction.normalized();
    double nearest = 1e9;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d albedo = Eigen::Vector3d::Ones();
    if (d.y() < 0.0) {  // Floor y = 0.
      nearest = -eye.y() / d.y();
      const Eigen::Vector3d p = eye + nearest * d;
      normal = Eigen::Vector3d::UnitY();
      const auto square = static_cast<long>(std::floor(p.x() * 2.0) + std::floor(p.z() * 2.0));
      albedo = square % 2 == 0 ? Eigen::Vector3d(0.8, 0.75, 0.7) : Eigen::Vector3d(0.1, 0.15, 0.3);
    }
    if (d.z() < 0.0) {  // Wall z = -8, up to y = 3.
      const double t = (-8.0 - eye.z()) / d.z();
      if (t > 0.0 && t < nearest && eye.y() + t * d.y() < 3.0) {
        nearest = t;
        normal = Eigen::Vector3d::UnitZ();
        albedo = Eigen::Vector3d(0.6, 0.4, 0.3);
      }
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d centre(-1.6 + 1.6 * i, 0.7, -4.5 - 0.7 * i);
      const Eigen::Vector3d to = centre - eye;
      const double along = to.dot(d);
      const double gap2 = to.squaredNorm() - along * along;
      if (gap2 > 0.49 || along <= 0.0) continue;
      const double t = along - std::sqrt(0.49 - gap2);
      if (t <= 0.0 || t >= nearest) continue;
      nearest = t;
      normal = (eye + t * d - centre).normalized();
      albedo = i == 1 ? Eigen::Vector3d(0.9, 0.9, 0.9) : Eigen::Vector3d(0.7, 0.2, 0.1);
    }
    if (nearest >= 1e9) return {.light = Eigen::Vector3f(0.4f, 0.6f, 0.9f)};
    Hit hit;
    hit.albedo = albedo.cast<float>();
    hit.normal = normal.cast<float>();
    hit.distance = static_cast<float>(nearest);
    hit.light = irradiance(eye + nearest * d, normal).cast<float>();
    hit.noisy = true;
    return hit;
  }

  /// Irradiance of the sky and of a lamp at (3, 5, -2), whose shadow of each sphere has a penumbra of half a metre.
  [[nodiscard]] static Eigen::Vector3d irradiance(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d lamp(3.0, 5.0, -2.0);
    const Eigen::Vector3d to = lamp - p;
    double lit = std::max(0.0, normal.dot(to.normalized())) * 30.0 / to.squaredNorm();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d centre(-1.6 + 1.6 * i, 0.7, -4.5 - 0.7 * i);
      const double along = (centre - p).dot(to.normalized());
      if (along <= 0.05) continue;
      const double gap = (p + along * to.normalized() - centre).norm();
      lit *= std::clamp((gap - 0.6) / 0.2, 0.0, 1.0);
    }
    return Eigen::Vector3d(0.25, 0.3, 0.4) * (0.5 + 0.5 * normal.y()) + lit * Eigen::Vector3d(1.0, 0.9, 0.7);
  }

  [[nodiscard]] Eigen::Vector3d direction_at(double u, double v) const {
    return Eigen::AngleAxisd(-heading_rad, Eigen::Vector3d::UnitY()) * panorama.direction_at({u, v});
  }

  /// Returns a film of the whole panorama.
  [[nodiscard]] render::Film film(int samples, std::uint64_t seed) const {
    render::Film film(panorama.width_px, panorama.height_px, true);
    std::mt19937 generator(seed * 7919 + 1);
    std::uniform_real_distribution<double> uniform;
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        Hit mean{.albedo = Eigen::Vector3f::Zero()};
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int i = 0; i < samples; ++i) {
          const Hit hit = intersect(direction_at(x + uniform(generator), y + uniform(generator)));
          const Eigen::Vector3f radiance =
              hit.albedo.cwiseProduct(hit.light) * static_cast<float>(hit.noisy ? factor(generator, i, samples) : 1.0);
          const float scale = 1.0f / static_cast<float>(samples);
          mean.albedo += hit.albedo * scale;
          mean.normal += hit.normal * scale;
          mean.distance += hit.distance * scale;
          sum += radiance;
          const float luminance = radiance.dot(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f));
          *film.square.at(x, y) += luminance * luminance;
        }
        Eigen::Vector3f::Map(film.sum.at(x, y)) = sum;
        *film.samples.at(x, y) = samples;
        Eigen::Vector3f::Map(film.features.albedo.at(x, y)) = mean.albedo;
        Eigen::Vector3f::Map(film.features.normal.at(x, y)) = mean.normal;
        *film.features.distance.at(x, y) = mean.distance;
      }
    }
    return film;
  }

  /// Returns a random factor of mean 1.
  [[nodiscard]] double factor(std::mt19937& generator, int sample, int samples) const {
    if (noise == 0.0) return 1.0;
    std::uniform_real_distribution<double> uniform;
    const double u = stratified ? (sample + uniform(generator)) / samples : uniform(generator);
    double value = 0.5 - 0.4 * std::log(1.0 - u);
    if (firefly_every == 0.0) return value + 0.1;
    if (uniform(generator) * firefly_every < 1.0) value += 0.1 * firefly_every;
    return value;
  }

  /// Returns the true picture, sampled at `side` times `side` positions in each pixel.
  [[nodiscard]] RadianceImage truth(int side = 8) const {
    RadianceImage image(panorama.width_px, panorama.height_px);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int i = 0; i < side * side; ++i) {
          const Hit hit = intersect(direction_at(x + (i % side + 0.5) / side, y + (i / side + 0.5) / side));
          sum += hit.albedo.cwiseProduct(hit.light);
        }
        Eigen::Vector3f::Map(image.at(x, y)) = sum / static_cast<float>(side * side);
      }
    }
    return image;
  }

  [[nodiscard]] denoise::PixelRays rays() const {
    return denoise::panorama_rays(panorama, heading_rad, {0, 0, panorama.width_px, panorama.height_px});
  }
};

}  // namespace cyclorama
