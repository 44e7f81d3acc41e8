// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/text_font.h"
#include "common/base/result.h"
#include "common/image/image.h"
#include "common/reach/page_reach.h"

namespace cyclorama::display {

/// Draws in the language of `reach` how to reach the operator page for one head: a QR code for phones, and name,
/// addresses, fingerprint and version as text. All of it lies in the middle of the picture, since neighbouring heads
/// overlap at the edges. Errors: kSystem if the link does not fit into a QR code.
Result<RgbaImage> reach_picture(const PageReach& reach, const TextFont& font, int width_px, int height_px);

}  // namespace cyclorama::display
