// SPDX-License-Identifier: Apache-2.0
/// Pictures that hold more than is shown, so that they can be turned, and pictures that serve several walls. Reentrant.
/// No wall asks for an equirectangular one: it does not grow, cannot be turned, and covers nothing but itself.
#pragma once

#include <optional>

#include "common/geometry/projection.h"

namespace cyclorama {

/// The same picture grown so that it can be turned by at least `guard_rad` either way, at the same size of pixels and a
/// width that is a multiple of 16: what the farm renders. A panorama as Panorama::with_guard_band(). A perspective by
/// what its corners need; by less where they would come to lie beyond 80 degrees. A fisheye by as much as its circle
/// moves: hardly, if it looks at the zenith. All up to 16384 pixels.
[[nodiscard]] PictureShape with_guard_band(const PictureShape& shape, double guard_rad);

/// The same of a picture for one eye or two; with two, each eye's part ends on a cut of kCutPx pixels.
[[nodiscard]] Projection with_guard_band(const Projection& picture, double guard_rad);

/// The same field, its height rounded up to a multiple of kCutPx, and to no more than two of them one above the other
/// may have: so that no JPEG block and no cell shows something to both eyes.
[[nodiscard]] PictureShape cut_for_two_eyes(const PictureShape& shape);

/// How far `picture` can be turned either way before one who is shown `shown` sees its edge; infinite if there is none,
/// 0 if the two differ in more than their extent.
[[nodiscard]] double turn_reach(const PictureShape& picture, const PictureShape& shown);

/// The smallest picture that covers both, with the finer pixels of the two, as far as the largest picture allows.
/// Nothing if they differ in kind or in tilt: then no picture serves both.
[[nodiscard]] std::optional<PictureShape> covering(const PictureShape& a, const PictureShape& b);

}  // namespace cyclorama
