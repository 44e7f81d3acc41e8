// SPDX-License-Identifier: Apache-2.0
/// All parameters that decide how a scene becomes the bytes that leave the node: one point in the trade-off of time and
/// bytes against accuracy.
#pragma once

#include "common/base/result.h"
#include "renderfarm/render/quality.h"

namespace cyclorama::render {

inline constexpr double kMinScale = 0.125;

struct PictureQuality {
  RenderQuality render;
  double scale = 1.0;            ///< Rendered pixels per displayed pixel, along each axis: kMinScale to 1.
  bool denoise = false;          ///< Applied before tone mapping.
  int jpeg_quality = 85;         ///< 1 to 100.
  bool subsample_chroma = true;  ///< True for 4:2:0, false for 4:4:4.

  friend bool operator==(const PictureQuality&, const PictureQuality&) = default;
};

/// Checks all parameters. Errors: see validate(RenderQuality).
[[nodiscard]] Status validate(const PictureQuality& quality);

}  // namespace cyclorama::render
