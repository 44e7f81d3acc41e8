// SPDX-License-Identifier: Apache-2.0
/// Environment light: a map or the gradient sky, with directions sampled by brightness.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Light from infinitely far. A value; queries are thread-safe.
///
/// The map is divided into cells whose corners are texel centres, such that radiance is bilinear in (u, v) within each.
/// A cell is chosen by its power, descending a pyramid of sums (Clarberg et al., "Wavelet Importance Sampling", 2005),
/// which keeps neighbouring samples together; a position within it is chosen in proportion to the bilinear luminance.
/// The pdf is thus zero only where there is no light. The gradient sky is smooth: the pdf is proportional to the cosine
/// at the surface, which gives matte surfaces in the open hardly any noise, or to luminance if the surface is lit from
/// both sides.
class EnvironmentLight {
 public:
  EnvironmentLight() = default;  ///< Creates an environment without light.
  /// The light comes from `sky` if `map` is null, otherwise from the map alone.
  EnvironmentLight(const scene::Sky& sky, std::shared_ptr<const scene::EnvironmentMap> map);

  [[nodiscard]] bool shines() const { return shines_; }
  [[nodiscard]] Vec3 radiance(const Vec3& direction) const;
  /// Samples a direction for a surface with normal `n`; a zero `n` is a surface lit from both sides. Returns false if
  /// `u` leads to no light. Precondition: shines().
  [[nodiscard]] bool sample(const Vec3& n, const Vec2& u, LightSample* ret_sample) const;
  /// Returns the pdf of sample() per steradian.
  [[nodiscard]] float pdf(const Vec3& n, const Vec3& direction) const;
  /// Returns an estimate of the irradiance (luminance) on an unshadowed surface with normal `n`; a zero `n` gathers
  /// light from all directions. The result is positive if any light comes from that side.
  [[nodiscard]] float estimate(const Vec3& n) const;

 private:
  /// A cell and a position in it; x and y are in [0, 1].
  struct Place {
    int column = 0;
    int row = 0;
    float x = 0.0f;
    float y = 0.0f;
  };
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<float> sums;
    [[nodiscard]] float at(int x, int y) const {
      return x < width && y < height
                 ? sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]
                 : 0.0f;
    }
  };

  void measure_sky();
  void measure_map();
  void add_to_faces(const Vec3& direction, float power);
  [[nodiscard]] Place place_of(const Vec3& direction) const;
  [[nodiscard]] Vec3 direction_of(const Place& place, float* ret_sine) const;
  [[nodiscard]] const float* texel(int column, int row) const;
  [[nodiscard]] std::array<float, 4> corner_luminances(int column, int row) const;
  [[nodiscard]] Vec3 map_radiance(const Place& place) const;
  [[nodiscard]] float map_pdf(const Place& place, float sine) const;
  [[nodiscard]] bool sample_sky(const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] bool sample_sky_over(const Vec3& n, const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] bool sample_map(const Vec2& u, LightSample* ret_sample) const;

  bool shines_ = false;
  scene::Sky sky_;
  std::shared_ptr<const scene::EnvironmentMap> map_;
  std::vector<Level> levels_;     ///< Sums of luminance times solid angle, from the cells down to a single number.
  float total_ = 0.0f;            ///< Luminance over the whole sphere.
  float upper_ = 0.0f;            ///< Sky: luminance over the upper half.
  std::array<float, 6> faces_{};  ///< Irradiance of surfaces that face +x, -x, +y, -y, +z, -z.
};

}  // namespace cyclorama::render
