// SPDX-License-Identifier: Apache-2.0
/// Painting and pigments. Shapes are signed distances in metres; edges are blurred by the distance between vertices, so
/// that a pattern too fine for the grid becomes its mean colour instead of noise.
#pragma once

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

namespace pigment {
inline const Vec3 kCinnabar{0.62f, 0.20f, 0.14f};
inline const Vec3 kRust{0.47f, 0.24f, 0.16f};
inline const Vec3 kOchre{0.76f, 0.55f, 0.29f};
inline const Vec3 kMalachite{0.24f, 0.50f, 0.40f};
inline const Vec3 kPaleGreen{0.52f, 0.66f, 0.54f};
inline const Vec3 kAzurite{0.16f, 0.33f, 0.52f};
inline const Vec3 kPaleBlue{0.47f, 0.61f, 0.68f};
inline const Vec3 kIndigo{0.10f, 0.15f, 0.25f};
inline const Vec3 kWhite{0.89f, 0.84f, 0.74f};
inline const Vec3 kPlaster{0.72f, 0.61f, 0.47f};
inline const Vec3 kRock{0.50f, 0.41f, 0.32f};
inline const Vec3 kGold{0.87f, 0.66f, 0.28f};
inline const Vec3 kFlesh{0.84f, 0.65f, 0.47f};
inline const Vec3 kInk{0.15f, 0.11f, 0.09f};
}  // namespace pigment

/// Returns the share of a vertex's surroundings that is inside a shape at signed distance `distance` (negative inside).
[[nodiscard]] inline float coverage(float distance, float spacing) { return unit_clamp(0.5f - distance / spacing); }

/// Returns the coverage by a line of width `width` along distance 0.
[[nodiscard]] inline float line_coverage(float distance, float width, float spacing) {
  return coverage(std::abs(distance) - 0.5f * width, spacing) * std::min(1.0f, width / spacing + 0.25f);
}

/// A point of a painting, on which colours are laid over each other.
class Spot {
 public:
  explicit Spot(const Vec3& ground) : colour_(ground) {}
  void lay(const Vec3& colour, float amount) { colour_ += (colour - colour_) * amount; }
  void darken(float amount) { colour_ *= 1.0f - amount; }
  [[nodiscard]] const Vec3& colour() const { return colour_; }

 private:
  Vec3 colour_;
};

/// Returns an approximate distance to an ellipse: exact on its outline, elsewhere wrong by at most a factor of the
/// ratio of the radii.
[[nodiscard]] inline float ellipse(const Vec2& p, const Vec2& centre, const Vec2& radii) {
  const Vec2 q = (p - centre).cwiseQuotient(radii);
  return (q.norm() - 1.0f) * radii.minCoeff();
}

[[nodiscard]] inline float box(const Vec2& p, const Vec2& centre, const Vec2& half) {
  const Vec2 q = (p - centre).cwiseAbs() - half;
  return q.cwiseMax(0.0f).norm() + std::min(q.maxCoeff(), 0.0f);
}

/// Returns the distance to a brush stroke whose radius changes from `ra` to `rb`.
[[nodiscard]] inline float stroke(const Vec2& p, const Vec2& a, float ra, const Vec2& b, float rb) {
  const Vec2 ab = b - a;
  const float t = unit_clamp((p - a).dot(ab) / ab.squaredNorm());
  return (p - a - t * ab).norm() - mix(ra, rb, t);
}

/// Number of the repeat of length `period` that contains `x`, and the position in it, in [-period/2, period/2).
struct Repeat {
  int index;
  float offset;
};
[[nodiscard]] inline Repeat repeat(float x, float period) {
  const float cell = std::floor(x / period);
  return {static_cast<int>(cell), x - (cell + 0.5f) * period};
}

/// Returns the non-negative remainder of i / length, for cycles of colours.
[[nodiscard]] inline int cycle(int i, int length) { return ((i % length) + length) % length; }

}  // namespace cyclorama::generator
