// SPDX-License-Identifier: Apache-2.0
/// Painted motifs for the walls, ceilings, floors and robes of a cave temple. Each function returns the colour of a
/// motif, which depends only on a position `p` on the face in metres (x to the right, y up) and on the distance between
/// vertices. The motifs are based on the repertoire of the Mogao caves (fifth to ninth century): thousand Buddhas,
/// scrolls, valances, lantern ceilings, apsaras, nimbuses.
#pragma once

#include <cstdint>

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

/// Size of one of the thousand small seated Buddhas.
inline constexpr float kCellWidth = 0.27f;
inline constexpr float kCellHeight = 0.33f;

/// Rows and columns of small seated Buddhas, whose colours change from cell to cell so that light diagonals appear.
[[nodiscard]] Vec3 thousand_buddhas(const Vec2& p, float spacing);

/// A band of height `height`, with p.y in [0, height]: a wavy stem with leaves and blossoms between two pearled
/// borders.
[[nodiscard]] Vec3 scroll_band(const Vec2& p, float height, float spacing);

/// A band of half lotus blossoms side by side.
[[nodiscard]] Vec3 petal_band(const Vec2& p, float height, float spacing);

/// The fringe of a canopy, which hangs from the top: pleats and overlapping pointed flags with tassels; p.y is in [0,
/// height].
[[nodiscard]] Vec3 valance(const Vec2& p, float height, float spacing);

/// A lotus seen from above, with the given radius, centred at the origin, on `ground`.
[[nodiscard]] Vec3 lotus(const Vec2& p, float radius, int petals, const Vec3& ground, float spacing);

/// A square of a lantern ceiling with half side `half`: nested squares, each turned by 45 degrees, around a lotus.
[[nodiscard]] Vec3 lantern(const Vec2& p, float half, float spacing);

/// Distance between flying apsaras, in metres.
inline constexpr float kApsaraWidth = 2.6f;
/// Sky with clouds and flying apsaras; p.y is in [0, height].
[[nodiscard]] Vec3 flying_apsaras(const Vec2& p, float height, float spacing);

/// Rings of a nimbus around a head or a body. `r` is 0 in the middle and 1 at the rim, `angle` runs around it; `metres`
/// is the length of one unit of `r`.
[[nodiscard]] Vec3 nimbus(float r, float angle, float metres, int scheme, float spacing);

/// Floor tiles with lotus reliefs. `ret_relief` becomes the height of the relief, in [0, 1].
[[nodiscard]] Vec3 floor_tile(const Vec2& p, float spacing, float* ret_relief);

/// A carpet or brocade of roundels on `ground`.
[[nodiscard]] Vec3 brocade(const Vec2& p, const Vec3& ground, const Vec3& figure, float spacing);

/// Ageing of a painting over a thousand years at `p3` (position in the room): fading, dust, soot, cracks, and flakes
/// that expose plaster and rock. `loss` in [0, 1] is the share of the paint that is lost.
struct Age {
  float plaster_lost = 0.0f;  ///< 1 where the rock is bare.
  float crack = 0.0f;
};
[[nodiscard]] Age age_of(const Vec3& p3, float loss, std::uint32_t seed);
[[nodiscard]] Vec3 aged(const Vec3& colour, const Age& age, const Vec3& p3, float loss, std::uint32_t seed);

}  // namespace cyclorama::generator
