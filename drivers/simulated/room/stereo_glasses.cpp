// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/room/stereo_glasses.h"

#include <algorithm>

namespace cyclorama::simulated {

RgbImage seen_through_glasses(const RgbImage& head, StereoPacking packing, Eye eye) {
  if (head.empty() || packing == StereoPacking::kFrameSequential) return head;
  const HeadPart part = part_of_eye(packing, eye, head.width(), head.height());
  RgbImage seen(head.width(), head.height());
  for (int y = 0; y < seen.height(); ++y) {
    const int from_y = part.y_px + y * part.height_px / head.height();
    for (int x = 0; x < seen.width(); ++x) {
      std::copy_n(head.at(part.x_px + x * part.width_px / head.width(), from_y), 3, seen.at(x, y));
    }
  }
  return seen;
}

}  // namespace cyclorama::simulated
