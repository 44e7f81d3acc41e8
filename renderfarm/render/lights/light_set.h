// SPDX-License-Identifier: Apache-2.0
/// All lights of a scene, for estimates of direct light: one light is chosen, and one position on it.
///
///     LightSample aim;
///     if (lights.sample(p, n, choice, u, &aim))
///       sum += bsdf(aim.direction) * aim.radiance_over_pdf * weight * levels[aim.group];
///
/// p is the start of the shadow ray, in the render frame. n is the normal of the lit side; lights behind it are not
/// chosen, and n = 0 stands for both sides. A ray that hits a light gets its radiance, and the pdf with which sample()
/// would have chosen that direction, as follows:
///
///     hits a placement         radiance: the material's emission    pdf(p, n, lights.of_triangle(...), ...)
///     hits a visible lamp      radiance(light, p, direction), times the level of group_of(light)
///                                                                   pdf(p, n, light, ...)
///     hits nothing             environment(direction)               environment_pdf(p, n, direction)
///
/// A pdf is per steradian and includes the choice of the light. 0 means that sample() never chooses the direction, so
/// the hit has full weight.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderfarm/render/lights/emissive_triangles.h"
#include "renderfarm/render/lights/environment_light.h"
#include "renderfarm/render/lights/flat_light.h"
#include "renderfarm/render/lights/lamp.h"
#include "renderfarm/render/lights/light_list.h"
#include "renderfarm/render/lights/light_tree.h"

namespace cyclorama::render {

/// Index of a light with a position. Lamps (points, spots, spheres) come first, then rectangles and disks, then
/// triangles.
using LightIndex = int;
inline constexpr LightIndex kNoLight = -1;

/// The lights of a scene. A value; queries are thread-safe. Lights without power or with non-finite parameters are left
/// out.
class LightSet {
 public:
  LightSet() = default;  ///< Creates a set without lights.
  /// Borrows `placements`, which must neither move nor change. `environment` may be null; otherwise it replaces `sky`.
  LightSet(const std::vector<scene::Light>& lights, const Eigen::Vector3d& origin,
           const std::vector<Placement>& placements, const scene::Sky& sky,
           std::shared_ptr<const scene::EnvironmentMap> environment);

  [[nodiscard]] bool empty() const { return !has_finite() && suns_.empty() && !environment_.shines(); }
  [[nodiscard]] bool has_environment() const { return environment_.shines(); }

  /// Samples a light; `choice` and `u` are in [0, 1). Returns false if they lead to no light.
  [[nodiscard]] bool sample(const Vec3& p, const Vec3& n, float choice, const Vec2& u, LightSample* ret_sample) const;
  /// Returns the pdf for a ray from `p` that hit `light` after `distance`.
  [[nodiscard]] float pdf(const Vec3& p, const Vec3& n, LightIndex light, const Vec3& direction, float distance) const;
  [[nodiscard]] Vec3 environment(const Vec3& direction) const { return environment_.radiance(direction); }
  [[nodiscard]] float environment_pdf(const Vec3& p, const Vec3& n, const Vec3& direction) const;

  /// Returns the light of triangle `primitive` of a placement; kNoLight if it is not sampled.
  [[nodiscard]] LightIndex of_triangle(unsigned placement, unsigned primitive) const;
  /// Returns the radiance that a ray from `p` receives from the visible lamp that it hit; zero from behind the lamp,
  /// and for triangles.
  [[nodiscard]] Vec3 radiance(LightIndex light, const Vec3& p, const Vec3& direction) const;

  /// Returns the group of a light (scene/lamp_groups.h); 0 for triangles.
  [[nodiscard]] std::size_t group_of(LightIndex light) const;

  [[nodiscard]] bool chooses_by_tree() const { return !tree_.empty(); }
  [[nodiscard]] std::span<const Lamp> suns() const { return suns_; }
  [[nodiscard]] std::span<const Lamp> lamps() const { return lamps_; }
  [[nodiscard]] std::span<const FlatLight> flats() const { return flats_; }
  [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }
  /// Returns the number of lights with a position, which is above every LightIndex.
  [[nodiscard]] std::size_t size() const { return lamps_.size() + flats_.size() + triangles_.size(); }
  [[nodiscard]] LightIndex index_of_lamp(std::size_t lamp) const { return static_cast<LightIndex>(lamp); }
  [[nodiscard]] LightIndex index_of_flat(std::size_t flat) const {
    return static_cast<LightIndex>(lamps_.size() + flat);
  }
  [[nodiscard]] std::size_t bytes() const;  ///< Excludes the environment's map.

 private:
  /// Probability with which each kind of light is chosen.
  struct Shares {
    float finite = 0.0f;
    float suns = 0.0f;
    float environment = 0.0f;
  };
  [[nodiscard]] bool has_finite() const { return list_.size() > 0 || !tree_.empty(); }
  [[nodiscard]] LightBounds bounds(std::size_t light) const;
  [[nodiscard]] float sun_estimate(const Lamp& sun, const Vec3& n) const;
  [[nodiscard]] float suns_estimate(const Vec3& n) const;
  [[nodiscard]] Shares shares(float finite, const Vec3& n) const;
  [[nodiscard]] bool sample_finite(LightIndex light, const Vec3& p, const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] bool sample_sun(const Vec3& n, const Choice& choice, const Vec2& u, LightSample* ret_sample) const;
  [[nodiscard]] float finite_pdf(LightIndex light, const Vec3& p, const Vec3& direction, float distance) const;

  std::vector<Lamp> lamps_;
  std::vector<FlatLight> flats_;
  EmissiveTriangles triangles_;
  std::vector<Lamp> suns_;  ///< Directional lamps.
  EnvironmentLight environment_;
  LightList list_;  ///< Used for few lights with a position; `tree_` is used for many.
  LightTree tree_;
};

}  // namespace cyclorama::render
