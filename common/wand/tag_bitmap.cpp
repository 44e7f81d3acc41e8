// SPDX-License-Identifier: Apache-2.0
#include "common/wand/tag_bitmap.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <cstdint>
#include <cstdlib>

#include "common/base/check.h"

namespace cyclorama {

TagBitmap tag_bitmap(int id) {
  apriltag_family_t* const family = tag36h11_create();
  CHECK(id >= 0 && id < static_cast<int>(family->ncodes));
  // 16 bits fit both libraries: Debian 12's takes an int here, Debian 13's an unsigned int.
  image_u8_t* const image = apriltag_to_image(family, static_cast<std::uint16_t>(id));
  TagBitmap bitmap{image->width, static_cast<double>(family->total_width) / family->width_at_border, {}};
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) bitmap.white.push_back(image->buf[y * image->stride + x] > 127);
  }
  // Does the same as image_u8_destroy(), which Debian's library does not export.
  std::free(image->buf);
  std::free(image);
  tag36h11_destroy(family);
  return bitmap;
}

}  // namespace cyclorama
