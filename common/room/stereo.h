// SPDX-License-Identifier: Apache-2.0
/// How heads show two eyes' pictures.
///
///     side-by-side          top-bottom            frame-sequential
///     ┌──────┬──────┐       ┌─────────────┐       ┌─────────────┐  at refreshes of an even number the left eye's,
///     │ left │ right│       │    left     │       │left / right │  at those of an odd number the right eye's
///     │  eye │  eye │       ├─────────────┤       │             │
///     └──────┴──────┘       │    right    │       └─────────────┘
///                           └─────────────┘
///
/// The projector draws each eye's part over its whole field again: side by side a pixel becomes twice as wide, one
/// above the other twice as high.
#pragma once

#include <cstdint>

#include "common/room/pinhole.h"

namespace cyclorama {

enum class StereoPacking { kSideBySide, kTopBottom, kFrameSequential };
enum class Eye { kLeft, kRight };

/// Of all heads of an installation.
struct InstalledStereo {
  StereoPacking packing = StereoPacking::kSideBySide;
  double eye_distance_m = 0.063;
};

/// A rectangle of a head's pixels, from its upper left corner.
struct HeadPart {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
  friend bool operator==(const HeadPart&, const HeadPart&) = default;
};

/// Where on a head of that size an eye's picture is. Precondition: a side that both eyes share is even.
[[nodiscard]] HeadPart part_of_eye(StereoPacking packing, Eye eye, int width_px, int height_px);

/// The same light, of the pixels that one eye gets of it. The same precondition.
[[nodiscard]] Pinhole lens_of_eye(const Pinhole& lens, StereoPacking packing);

/// Which eye a frame-sequential head shows at a refresh.
[[nodiscard]] constexpr Eye eye_at(std::int64_t refresh) { return refresh % 2 == 0 ? Eye::kLeft : Eye::kRight; }

}  // namespace cyclorama
