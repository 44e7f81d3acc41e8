// SPDX-License-Identifier: Apache-2.0
/// Chooses among a few lights by evaluating each: better than LightTree for small numbers.
#pragma once

#include <array>
#include <vector>

#include "renderfarm/render/lights/light_lanes.h"
#include "renderfarm/render/lights/light_tree.h"

namespace cyclorama::render {

/// A list of up to kMaxListedLights lights. A value; queries are thread-safe.
class LightList {
 public:
  /// Maximum number of lights; the tree is better beyond it. Measured with point lights in a box of 20 m: the time of a
  /// choice in ns (a shadow ray takes about 200 ns), and the variance that the choice alone adds to the estimate,
  /// relative to the square of the estimate:
  ///
  ///     lights      16      32      64      128     256     variance
  ///     list        61      109     187     352     673     0
  ///     tree        53      75      81      105     132     0.2 - 1.0
  static constexpr std::size_t kMaxListedLights = 64;

  /// Approximate upper bounds of each light's irradiance (luminance) at one point, and their sum.
  struct Estimates {
    std::array<float, kMaxListedLights> each;
    float sum = 0.0f;
  };

  /// Adds a light. Precondition: size() < kMaxListedLights.
  void add(const LightBounds& light);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Estimates each light; an estimate is zero only if the light cannot shine. A zero `n` is a surface lit from both
  /// sides.
  void estimate(const Vec3& p, const Vec3& n, Estimates* ret_estimates) const;
  /// Chooses a light with a probability proportional to its estimate. Returns the light's index, or -1 if none can
  /// shine.
  [[nodiscard]] int choose(const Estimates& estimates, const Choice& choice, float* ret_probability) const;

 private:
  std::vector<LightLanes> lanes_;
  std::size_t size_ = 0;
};

}  // namespace cyclorama::render
