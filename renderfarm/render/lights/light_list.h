// SPDX-License-Identifier: Apache-2.0
/// Chooses among a few lights by looking at each of them: better than LightTree where they are few.
#pragma once

#include <array>
#include <vector>

#include "renderfarm/render/lights/light_lanes.h"
#include "renderfarm/render/lights/light_tree.h"

namespace cyclorama {

/// A value; queries are thread-safe.
class LightList {
 public:
  /// Among more the tree is better. Measured with points in a box of 20 m (ns for the choice; variance of the estimate
  /// that the choice alone adds, relative to its square; a shadow ray costs some 200 ns):
  ///
  ///     lights      16      32      64      128     256
  ///     list        61      109     187     352     673       0
  ///     tree        53      75      81      105     132       0.2 - 1.0
  static constexpr std::size_t kMost = 64;

  /// What each light gives to one place at most about (irradiance, luminance), and their sum.
  struct Estimates {
    std::array<float, kMost> each;
    float sum = 0.0f;
  };

  /// Precondition: fewer than kMost so far.
  void add(const LightBounds& light);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Zero only where a light cannot shine. A zero `n` is a surface that is lit from both sides.
  void estimate(const Vec3& p, const Vec3& n, Estimates* ret_estimates) const;
  /// Returns the light's index, -1 if none can shine.
  [[nodiscard]] int choose(const Estimates& estimates, const Choice& choice, float* ret_probability) const;

 private:
  std::vector<LightLanes> lanes_;
  std::size_t size_ = 0;
};

}  // namespace cyclorama
