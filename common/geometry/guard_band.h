// SPDX-License-Identifier: Apache-2.0
/// Pictures that are larger than what is shown, so that they can be turned and moved, and pictures that serve several
/// walls. Reentrant. An equirectangular picture is never made for a wall, so it never grows, cannot be turned, and
/// serves together with no other picture.
#pragma once

#include <optional>

#include "common/geometry/projection.h"

namespace cyclorama {

/// Returns the picture grown so that it can be turned by at least `guard_rad` either way, with pixels of the same size
/// and a width that is a multiple of 16; the farm renders this picture. A panorama grows as in
/// Panorama::with_guard_band(); a perspective as its corners require, or less where they would be beyond 80 degrees; a
/// fisheye by the movement of its circle, which is small near the zenith. At most 16384 pixels each way.
///
/// After the turn, each direction may deviate by another `parallax_rad` to any side, so that the picture can also be
/// moved to an eye beside its own. All edges grow by that angle; those of a panorama and of a perspective at most to 80
/// degrees from the horizon or the axis.
[[nodiscard]] PictureShape with_guard_band(const PictureShape& shape, double guard_rad, double parallax_rad = 0.0);

/// Same for a picture for one eye or two; with two, each eye's part ends at a multiple of kCutPx pixels.
[[nodiscard]] Projection with_guard_band(const Projection& picture, double guard_rad, double parallax_rad = 0.0);

/// Returns the largest angle by which a surface at `distance_m` or farther changes its direction when the eye moves by
/// `moved_m`; a right angle if the eye may reach it.
[[nodiscard]] double parallax(double moved_m, double distance_m);

/// Returns the same field with a height rounded up to a multiple of kCutPx, so that no JPEG block and no cell belongs
/// to both eyes, and limited so that two such pictures fit one above the other.
[[nodiscard]] PictureShape cut_for_two_eyes(const PictureShape& shape);

/// Returns the angle by which `picture` can be turned either way before a viewer of `shown` sees the picture's edge;
/// infinite if the picture has no edge, 0 if the two differ in more than their extent.
[[nodiscard]] double turn_reach(const PictureShape& picture, const PictureShape& shown);

/// Returns the smallest picture that covers both, with the finer pixels of the two, up to the maximum picture size.
/// Empty if they differ in kind or in tilt, since no picture then serves both.
[[nodiscard]] std::optional<PictureShape> covering(const PictureShape& a, const PictureShape& b);

}  // namespace cyclorama
