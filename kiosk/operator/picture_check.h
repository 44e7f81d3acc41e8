// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/image/image.h"

namespace cyclorama {

/// True when nothing can be seen: hardly any pixel differs from the middle of all by more than a few levels.
[[nodiscard]] bool is_blank(const RgbImage& picture);

/// How much of the picture changed, in [0, 1]: the share of pixels that differ by more than JPEG's noise; 1 for
/// pictures of different sizes.
[[nodiscard]] double changed_share(const RgbImage& before, const RgbImage& after);

/// Averaged down so that it is at most `width` wide, keeping its shape; a smaller one stays as it is.
[[nodiscard]] RgbImage shrunk(const RgbImage& picture, int width);

/// Pictures side by side in rows, on a dark ground, each shrunk to `cell_width`. Rows may differ in length and height;
/// an empty picture leaves its place dark.
[[nodiscard]] RgbImage contact_sheet(const std::vector<std::vector<RgbImage>>& rows, int cell_width);

}  // namespace cyclorama
