// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "appliance/display/head_upload.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/image/image.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::display {

/// Text on the wall: a plate that darkens the picture, with light letters. A value.
struct Caption {
  GreyImage ink;  ///< Coverage by letters; empty: nothing is written.
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double width = 0.0;  ///< Size in the units of wire::Caption.
  double height = 0.0;
};

/// Light of the letters in relation to a projector's white, and what the plate leaves of the picture's light. Their
/// contrast is at least 7 to 1 on any picture, as WCAG 2.1 demands for its level AAA.
inline constexpr float kInkLight = 0.85f;
inline constexpr float kPlateLeaves = 0.06f;
inline constexpr int kMaxCaptionWidthPx = 4096;
inline constexpr int kMaxCaptionHeightPx = 2048;

/// Errors: kBadData if the sizes do not fit the ink, or are not within the limits of museum.proto.
Result<Caption> caption_of(const wire::Caption& message);

/// Maps to the caption, whose upper left corner is (0, 0) and whose lower right corner is (1, 1): multiply and divide by
/// the third coordinate, which is positive in front of it. From a picture's position (across, up, 1); in a fisheye, from
/// a direction in the picture's axes (R_eye_picture()). Precondition: the caption is not empty, the picture not
/// equirectangular.
[[nodiscard]] Eigen::Matrix3d to_caption(const PictureShape& picture, const Caption& caption);

/// A caption in the graphics card's memory, as it is drawn in one refresh.
struct ShownCaption {
  unsigned texture = 0;  ///< Its upper left part holds the ink.
  int width_px = 0;
  int height_px = 0;
  int texture_width_px = 0;
  int texture_height_px = 0;
  double share = 0.0;  ///< 0: nothing is written; 1: whole.
};

/// Pixels of the coarsest and of the finest head for each unit of its warp, in the middle; 0: unknown.
struct PixelDensity {
  double min = 0.0;
  double max = 0.0;
};
[[nodiscard]] PixelDensity pixel_density(const std::vector<HeadPlan>& heads);

}  // namespace cyclorama::display
