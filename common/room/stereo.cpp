// SPDX-License-Identifier: Apache-2.0
#include "common/room/stereo.h"

#include "common/base/check.h"

namespace cyclorama {

HeadPart part_of_eye(StereoPacking packing, Eye eye, int width_px, int height_px) {
  const bool is_right = eye == Eye::kRight;
  switch (packing) {
    case StereoPacking::kSideBySide:
      CHECK(width_px % 2 == 0);
      return {is_right ? width_px / 2 : 0, 0, width_px / 2, height_px};
    case StereoPacking::kTopBottom:
      CHECK(height_px % 2 == 0);
      return {0, is_right ? height_px / 2 : 0, width_px, height_px / 2};
    case StereoPacking::kFrameSequential:
      break;
  }
  return {0, 0, width_px, height_px};
}

Pinhole lens_of_eye(const Pinhole& lens, StereoPacking packing) {
  const HeadPart part = part_of_eye(packing, Eye::kLeft, lens.width_px, lens.height_px);
  return lens.with_pixels(part.width_px, part.height_px);
}

}  // namespace cyclorama
