// SPDX-License-Identifier: Apache-2.0
/// The scene's lamps, made ready for choosing one and for aiming at it.
#pragma once

#include <vector>

#include "renderfarm/render/lights/lamp.h"

namespace cyclorama {

/// One aim at a lamp.
struct LampAim {
  Vec3 direction = Vec3::Zero();  ///< Towards the lamp, unit length.
  float distance = 0.0f;          ///< To the lamp's surface; infinite for directional ones.
  Vec3 light = Vec3::Zero();      ///< Radiance over density: times BSDF and cosine it is an unbiased estimate.
};

/// Rebased to `origin`; lamps that shine nowhere are left out.
[[nodiscard]] std::vector<Lamp> make_lamps(const std::vector<Light>& lights, const Eigen::Vector3d& origin);

/// What falls on a surface at `p` with normal `n` if nothing is in the way: a bound for lamps with a size, exact for
/// those without. Zero only where the lamp cannot contribute.
[[nodiscard]] float estimate(const Lamp& lamp, const Vec3& p, const Vec3& n);

/// Aims at a place on the lamp chosen by `u`, uniformly in solid angle as seen from `p`.
[[nodiscard]] LampAim aim(const Lamp& lamp, const Vec3& p, const Vec2& u);

/// Chooses a lamp with probability in proportion to estimate(). Returns -1 if none contributes; otherwise
/// `ret_probability` is above zero.
[[nodiscard]] int choose_lamp(const std::vector<Lamp>& lamps, const Vec3& p, const Vec3& n, float u,
                              float* ret_probability);

}  // namespace cyclorama
