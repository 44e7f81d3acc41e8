// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "appliance/display/head_program.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "appliance/warp/pixel_map.h"
#include "common/geometry/picture_place.h"
#include "common/geometry/projection.h"
#include "common/room/stereo.h"

namespace cyclorama::display {

/// Plan of one projector's drawing: the positions of its pixels in the picture, their brightness, and the code values
/// of their light. In stereo, everything refers to the head's pixels for one eye (lens_of_eye()) and holds for both
/// eyes: a pixel lights one position on the wall, whichever eye's picture it shows.
struct HeadPlan {
  warp::Warp warp;
  warp::MaskImage mask;       ///< Must have the head's size.
  warp::HeadColour colour{};  ///< If there is a black lift, it must have the head's size.
  int depth_bits = 8;         ///< Bits of the output's code values per channel.
  bool is_dithered = true;
  PictureShape picture = Panorama{};  ///< Picture that the warp refers to; only its kind and tilt matter.
  /// Absent: the head shows one picture; of a stereo picture, that of the left eye.
  std::optional<StereoPacking> packing{};
};

/// A plan in the form that the graphics card takes. Making it needs no card, so that a thread without deadlines can do
/// it. A value.
struct HeadUpload {
  /// Preconditions: the plan's images have the same size, its response is valid, its picture is not equirectangular.
  explicit HeadUpload(const HeadPlan& plan);

  /// A texture with one or two values per pixel of the head, in rows from the bottom.
  struct PerPixel {
    int channels = 1;
    std::vector<float> values;  ///< Empty: the texture is not needed.
  };

  static constexpr int kGridColumns = 48;
  static constexpr int kGridRows = 27;
  /// An array, so that a painter keeps a copy without allocating.
  using Grid = std::array<PicturePlace, static_cast<std::size_t>((kGridColumns + 1) * (kGridRows + 1))>;

  int width_px;
  int height_px;
  PictureShape picture;
  std::optional<StereoPacking> packing;
  int depth_bits;
  warp::HeadColour colour;     ///< Only the matrix and the black levels.
  HeadFeatures features;       ///< All but `mask`, `edges`, `fade` and `texels`, which the painter sets.
  std::vector<float> corners;  ///< Per vertex: HeadProgram's kPosition and kDirection; for patches also its kTerms.
  bool has_terms = false;
  std::vector<std::uint32_t> indices;  ///< Corners of fully lit triangles, then those of triangles that need the mask.
  std::size_t wholly_lit = 0;          ///< Number of indices that belong to fully lit triangles.
  PerPixel mask;
  PerPixel map;
  /// Positions in the picture at the corners of kGridColumns x kGridRows cells of the head, in rows from the top; NaN
  /// where there is none.
  Grid grid{};
  std::vector<float> response;  ///< kResponseSteps codes of red, then of green, then of blue; empty: sRGB.

  /// Number of steps of the response. The nearest step is within a 20th of a code value on an sRGB curve; ./bench.sh
  /// display-trade measures the alternatives.
  static constexpr int kResponseSteps = 4096;
  static constexpr std::size_t kCornerFloats = 4;
  static constexpr std::size_t kTermFloats = 12;
};

}  // namespace cyclorama::display
