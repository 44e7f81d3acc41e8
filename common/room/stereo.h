// SPDX-License-Identifier: Apache-2.0
/// Packing of the pictures of two eyes on a head.
///
///     side-by-side          top-bottom            frame-sequential
///     ┌──────┬──────┐       ┌─────────────┐       ┌─────────────┐  refreshes with an even number show the left eye's
///     │ left │ right│       │    left     │       │left / right │  picture, those with an odd number the right eye's
///     │  eye │  eye │       ├─────────────┤       │             │
///     └──────┴──────┘       │    right    │       └─────────────┘
///                           └─────────────┘
///
/// The projector stretches each eye's part over its whole field: in side-by-side packing, pixels become twice as wide;
/// in top-bottom packing, twice as high.
#pragma once

#include <cstdint>

#include "common/room/pinhole.h"

namespace cyclorama {

enum class StereoPacking { kSideBySide, kTopBottom, kFrameSequential };
enum class Eye { kLeft, kRight };

/// Stereo settings of all heads of an installation.
struct InstalledStereo {
  StereoPacking packing = StereoPacking::kSideBySide;
  double eye_distance_m = 0.063;
};

/// A rectangle of a head's pixels; x and y are its upper left corner.
struct HeadPart {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
  friend bool operator==(const HeadPart&, const HeadPart&) = default;
};

/// Returns the part of a head of that size that shows an eye's picture. Precondition: the side that is divided between
/// the eyes is even.
[[nodiscard]] HeadPart part_of_eye(StereoPacking packing, Eye eye, int width_px, int height_px);

/// Returns the lens of the pixels that one eye receives. Precondition: that of part_of_eye().
[[nodiscard]] Pinhole lens_of_eye(const Pinhole& lens, StereoPacking packing);

/// Returns the eye that a frame-sequential head shows at a refresh.
[[nodiscard]] constexpr Eye eye_at(std::int64_t refresh) { return refresh % 2 == 0 ? Eye::kLeft : Eye::kRight; }

}  // namespace cyclorama
