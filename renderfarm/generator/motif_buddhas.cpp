// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

const Vec3 kGround{0.55f, 0.30f, 0.20f};

struct Scheme {
  Vec3 ground;
  Vec3 mandorla;
  Vec3 halo;
  Vec3 robe;
};

/// Returns one of eight colour schemes. Each column to the right advances by one scheme and each row up by three, which
/// gives diagonal rays.
const Scheme& scheme_of(int column, int row) {
  static const std::array<Scheme, 8> schemes = {{
      {kGround, kPaleGreen, kWhite, kCinnabar},
      {kGround, kAzurite, kOchre, kInk},
      {kGround, kWhite, kMalachite, kRust},
      {kGround, kMalachite, kOchre, kCinnabar},
      {kGround, kPaleBlue, kWhite, kRust},
      {kGround, kOchre, kAzurite, kMalachite},
      {kGround, kWhite, kPaleGreen, kCinnabar},
      {kGround, kIndigo, kOchre, kPaleBlue},
  }};
  return schemes[static_cast<std::size_t>(cycle(column + 3 * row, 8))];
}

void lay_figure(const Vec2& p, const Scheme& scheme, float spacing, Spot& spot) {
  const auto shape = [&](float x, float y, float rx, float ry) {
    return coverage(ellipse(p, {x, y}, {rx, ry}), spacing);
  };
  // Mandorla and halo, each with a light rim.
  spot.lay(kWhite, shape(0.0f, -0.010f, 0.112f, 0.130f));
  spot.lay(scheme.mandorla, shape(0.0f, -0.010f, 0.100f, 0.118f));
  spot.lay(kWhite, shape(0.0f, 0.072f, 0.061f, 0.061f));
  spot.lay(scheme.halo, shape(0.0f, 0.072f, 0.051f, 0.051f));
  // Lotus seat.
  spot.lay(kPaleGreen, shape(0.0f, -0.118f, 0.100f, 0.026f));
  spot.lay(kWhite, shape(0.0f, -0.110f, 0.088f, 0.016f));
  // Robe: lap, trunk; then the bare chest and the hands.
  const float lap = shape(0.0f, -0.083f, 0.092f, 0.036f);
  const float trunk = shape(0.0f, -0.020f, 0.056f, 0.070f);
  spot.lay(scheme.robe, std::max(lap, trunk));
  spot.lay(mix(scheme.robe, kInk, 0.45f), shape(0.0f, -0.101f, 0.075f, 0.006f));
  spot.lay(kFlesh, shape(0.0f, 0.020f, 0.021f, 0.034f));
  spot.lay(kFlesh, shape(0.0f, -0.062f, 0.027f, 0.012f));
  // Head, hair, topknot.
  spot.lay(kIndigo, shape(0.0f, 0.078f, 0.031f, 0.035f));
  spot.lay(kIndigo, shape(0.0f, 0.112f, 0.013f, 0.013f));
  spot.lay(kFlesh, shape(0.0f, 0.067f, 0.027f, 0.029f));
}

}  // namespace

Vec3 thousand_buddhas(const Vec2& p, float spacing) {
  const auto [column, x] = repeat(p.x(), kCellWidth);
  const auto [row, y] = repeat(p.y(), kCellHeight);
  const Scheme& scheme = scheme_of(column, row);
  Spot spot(scheme.ground);
  // A canopy over the head, and the strip for the name.
  const Vec2 local{x, y};
  spot.lay(kMalachite, coverage(ellipse(local, {0.0f, 0.146f}, {0.075f, 0.016f}), spacing));
  const float beside = std::abs(x) - 0.5f * kCellWidth;
  spot.lay(kWhite, coverage(std::max(std::abs(beside) - 0.011f, std::abs(y - 0.085f) - 0.055f), spacing));
  lay_figure(local, scheme, spacing, spot);
  // A thin light line between the rows.
  spot.lay(kOchre, line_coverage(std::abs(y) - 0.5f * kCellHeight, 0.014f, spacing));
  return spot.colour();
}

}  // namespace cyclorama::generator
