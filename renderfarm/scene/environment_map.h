// SPDX-License-Identifier: Apache-2.0
/// A picture of the light from all directions, visible where no triangle hides it.
#pragma once

#include "common/image/image.h"

namespace cyclorama::scene {

/// An equirectangular picture of linear radiance. Rows run from straight up (+y) to straight down, columns to the right
/// over a full turn. At rotation 0,
///
///     u = 0, 1: +z (behind)   u = 1/4: -x (left)   u = 1/2: -z (ahead)   u = 3/4: +x (right)
///
///     heading = 2 pi (u - 1/2) + rotation_rad     elevation = pi (1/2 - v)
///     direction = (sin heading cos elevation, sin elevation, -cos heading cos elevation)
///
/// with u, v in [0, 1] and the centre of the first texel at (1/2 / width, 1/2 / height). Radiance is bilinear between
/// texel centres: u wraps around, v is clamped to the outer rows. Texels are finite and not negative.
struct EnvironmentMap {
  RadianceImage pixels;       ///< Not empty.
  float rotation_rad = 0.0f;  ///< Turns the light to the right, as a heading does.
  float strength = 1.0f;      ///< Multiplies the radiance.
};

}  // namespace cyclorama::scene
