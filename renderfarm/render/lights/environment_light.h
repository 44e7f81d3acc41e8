// SPDX-License-Identifier: Apache-2.0
/// Light from all around: an environment map or the gradient sky, and directions chosen by how bright they are.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "renderfarm/render/lights/light_sample.h"
#include "renderfarm/scene/environment_map.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// A value; queries are thread-safe.
///
/// The map is cut into cells whose corners are texel centres, so that in each radiance is bilinear in (u, v). A cell is
/// chosen by what it gives, going down a pyramid of sums (Clarberg et al., "Wavelet Importance Sampling", 2005), which
/// keeps neighbouring samples neighbours; in it a place is chosen in proportion to the bilinear luminance. So the
/// density is nowhere zero where there is light. The gradient sky is smooth: its density is that of a surface's
/// cosine, which leaves matte surfaces in the open without noise, and in proportion to its luminance for both sides.
class EnvironmentLight {
 public:
  EnvironmentLight() = default;  ///< Dark.
  /// `map` may be null: then the sky shines, else the map alone.
  EnvironmentLight(const Sky& sky, std::shared_ptr<const EnvironmentMap> map);

  [[nodiscard]] bool shines() const { return shines_; }
  [[nodiscard]] Vec3 radiance(const Vec3& direction) const;
  /// For a surface with normal `n`; zero for both sides. Precondition: shines(). False where `u` meets nothing but
  /// black.
  [[nodiscard]] bool sample(const Vec3& n, const Vec2& u, LightSample* ret_sample) const;
  /// Per steradian; that of sample().
  [[nodiscard]] float density(const Vec3& n, const Vec3& direction) const;
  /// About the irradiance (luminance) on an unshadowed surface with normal `n`; for a zero one, from all around. Above
  /// zero wherever light comes from that side.
  [[nodiscard]] float estimate(const Vec3& n) const;

 private:
  /// A cell, and the place in it, both in [0, 1].
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
  [[nodiscard]] float map_density(const Place& place, float sine) const;
  [[nodiscard]] bool sample_sky(const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] bool sample_sky_over(const Vec3& n, const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] bool sample_map(const Vec2& u, LightSample* ret_sample) const;

  bool shines_ = false;
  Sky sky_;
  std::shared_ptr<const EnvironmentMap> map_;
  std::vector<Level> levels_;     ///< Of sums of luminance times solid angle: cells first, one number last.
  float total_ = 0.0f;            ///< Luminance over the whole sphere.
  float upper_ = 0.0f;            ///< Sky: of the upper half.
  std::array<float, 6> faces_{};  ///< Irradiance of surfaces that face +x, -x, +y, -y, +z, -z.
};

}  // namespace cyclorama
