// SPDX-License-Identifier: Apache-2.0
/// Every knob between a scene and the bytes that leave the node: one point of the trade of time and bytes for accuracy.
#pragma once

#include "common/base/result.h"
#include "renderfarm/render/quality.h"

namespace cyclorama {

inline constexpr double kLeastScale = 0.125;

/// A value.
struct PictureQuality {
  RenderQuality render;
  double scale = 1.0;            ///< Rendered pixels per shown pixel, along each side: kLeastScale to 1.
  bool denoise = false;          ///< Before tone mapping.
  int jpeg_quality = 85;         ///< 1 to 100.
  bool subsample_chroma = true;  ///< 4:2:0, else 4:4:4.

  friend bool operator==(const PictureQuality&, const PictureQuality&) = default;
};

/// As validate(RenderQuality).
[[nodiscard]] Status validate(const PictureQuality& quality);

}  // namespace cyclorama
