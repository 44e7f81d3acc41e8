// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {

Age age_of(const Vec3& p3, float loss, std::uint32_t seed) {
  Age age;
  const float patches = fractal_noise(p3 * 0.9f, 4, seed + 11u);
  // `loss` moves the threshold of one noise field: 0 leaves islands of damage, 1 leaves islands of paint.
  const float line = mix(0.55f, -0.35f, loss);
  age.plaster_lost = smooth_step(line, line + 0.05f, patches);
  age.crack = crack_lines(p3 * 0.8f, seed + 12u);
  return age;
}

Vec3 aged(const Vec3& colour, const Age& age, const Vec3& p3, float loss, std::uint32_t seed) {
  using namespace pigment;  // NOLINT(google-build-using-namespace)
  Spot spot(colour);
  const float slow = noise(p3 * 0.55f, seed + 21u);
  const float middle = fractal_noise(p3 * 3.1f, 2, seed + 22u);
  const float fine = noise(p3 * 23.0f, seed + 23u);
  // Dust and fading cover large patches; in small ones, pigment has flaked off down to the plaster.
  spot.lay(kPlaster, unit_clamp(0.08f + 0.20f * slow + 0.10f * middle));
  const float flake = smooth_step(0.40f - 0.25f * loss, 0.50f - 0.25f * loss, middle * 0.75f + fine * 0.3f);
  spot.lay(kPlaster * 1.04f, flake * 0.75f);
  spot.darken(0.10f * unit_clamp(fine + 0.3f));
  spot.darken(0.28f * unit_clamp(-slow - 0.1f));  // Old soot.
  const Vec3 rock = kRock * (1.0f + 0.18f * middle + 0.12f * fine);
  spot.lay(rock, age.plaster_lost);
  // The broken edge of the plaster casts a narrow shadow.
  const float rim = age.plaster_lost * (1.0f - age.plaster_lost) * 4.0f;
  spot.darken(0.35f * rim);
  spot.darken(0.6f * age.crack);
  return spot.colour();
}

}  // namespace cyclorama::generator
