// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/photo.h"

#include <algorithm>

namespace cyclorama::structured_light {

Photo photo_of(const GreyImage& codes) {
  Photo photo(codes.width(), codes.height());
  std::transform(codes.data().begin(), codes.data().end(), photo.data().begin(),
                 [](std::uint8_t code) { return static_cast<float>(code) / 255.0f; });
  return photo;
}

}  // namespace cyclorama::structured_light
