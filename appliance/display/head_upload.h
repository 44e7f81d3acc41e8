// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "appliance/display/head_program.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "appliance/warp/pixel_map.h"
#include "common/geometry/projection.h"
#include "common/room/stereo.h"

namespace cyclorama::display {

/// What one projector needs: where its pixels lie, how bright they may be, and which code values make its light. With
/// two eyes all this is said of the pixels that one eye gets of the head (lens_of_eye()), and holds for both: a
/// pixel lights one place of the wall, whichever eye's picture it shows there.
struct HeadPlan {
  warp::Warp warp;
  warp::MaskImage mask;       ///< Of the head's size.
  warp::HeadColour colour{};  ///< A black_lift has the head's size.
  int depth_bits = 8;         ///< Of the output's code values, each channel.
  bool is_dithered = true;
  PictureShape picture = Panorama{};       ///< Which places the warp tells: only its kind and tilt count.
  std::optional<StereoPacking> packing{};  ///< Nothing: one eye's picture; of two, the left eye's.
};

/// A plan as the graphics card takes it: all the work of a painter that needs no card, for a thread that may take its
/// time. A value.
struct HeadUpload {
  /// Precondition: the plan's pictures have one size, its response is valid, its picture is not equirectangular.
  explicit HeadUpload(const HeadPlan& plan);

  /// A texture of one value (or two) per pixel of the head; rows from the bottom.
  struct PerPixel {
    int channels = 1;
    std::vector<float> values;  ///< Empty: not needed.
  };

  int width_px;
  int height_px;
  PictureShape picture;
  std::optional<StereoPacking> packing;
  int depth_bits;
  warp::HeadColour colour;     ///< Its matrix and black.
  HeadFeatures features;       ///< But for `mask`, `edges`, `fade` and `texels`.
  std::vector<float> corners;  ///< Of triangles: place in clip space and in the picture; on patches their terms too.
  bool has_terms = false;
  std::vector<std::uint32_t> indices;  ///< Triangles that are wholly lit, then those that need the mask.
  std::size_t wholly_lit = 0;          ///< Of the indices.
  PerPixel mask;
  PerPixel map;
  std::vector<float> response;  ///< kResponseSteps codes of red, green and blue; empty: sRGB.

  /// As many that the nearest is within a 30th of a code value on an sRGB curve; ./bench.sh display-trade has the
  /// others.
  static constexpr int kResponseSteps = 4096;
  static constexpr std::size_t kCornerFloats = 4;
  static constexpr std::size_t kTermFloats = 12;
};

}  // namespace cyclorama::display
