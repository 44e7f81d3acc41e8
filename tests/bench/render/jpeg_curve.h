// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/result.h"
#include "common/image/jpeg.h"
#include "renderfarm/quality/shown_error.h"

namespace cyclorama {

/// Cost and error of a picture as JPEG tiles.
struct JpegPoint {
  int tile_px = 0;  ///< Side of the tiles; those at the right and lower edge may be smaller.
  JpegOptions options;
  std::size_t bytes = 0;
  double encode_ms_per_megapixel = 0.0;  ///< Thread time; the best of several.
  double decode_ms_per_megapixel = 0.0;
  quality::ShownError error{};  ///< Error of the decoded tiles against the picture.
};

/// Measures every quality and chroma with the largest tile, and every tile size with the usual quality. Reentrant.
/// Errors: kInvalidArgument for a picture smaller than the smallest tile.
Result<std::vector<JpegPoint>> measure_jpeg(const RgbImage& picture);

}  // namespace cyclorama
