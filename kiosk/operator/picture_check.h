// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/image/image.h"

namespace cyclorama::operations {

/// Returns true for an empty-looking picture: hardly any pixel differs from the median by more than a few levels.
[[nodiscard]] bool is_blank(const RgbImage& picture);

/// Returns the share of pixels that differ by more than JPEG's noise, in [0, 1]; 1 for pictures of different sizes.
[[nodiscard]] double changed_share(const RgbImage& before, const RgbImage& after);

/// Averages a picture down to at most `width`, keeping its aspect ratio; a smaller picture is not changed.
[[nodiscard]] RgbImage shrunk(const RgbImage& picture, int width);

/// Arranges pictures side by side in rows, on a dark ground, each shrunk to `cell_width`. Rows may differ in length and
/// height; an empty picture leaves its cell dark.
[[nodiscard]] RgbImage contact_sheet(const std::vector<std::vector<RgbImage>>& rows, int cell_width);

}  // namespace cyclorama::operations
