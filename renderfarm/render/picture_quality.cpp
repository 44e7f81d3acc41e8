// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/picture_quality.h"

namespace cyclorama::render {

Status validate(const PictureQuality& quality) {
  TRY(validate(quality.render));
  TRY(check_knob("scale", quality.scale, kMinScale, 1.0));
  return check_knob("jpeg_quality", quality.jpeg_quality, 1, 100);
}

}  // namespace cyclorama::render
