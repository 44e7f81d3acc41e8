// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "drivers/simulated/camera/tag_painter.h"

namespace cyclorama {

/// Returns a sharp, noise-free picture of a tag of 0.12 m on a grey background.
inline GreyImage painted_tag(int id, const RigidTransform<frame::Camera, frame::Tag>& pose, const Pinhole& lens) {
  Image<float, 1> light(lens.width_px, lens.height_px, 90.0f);
  simulated::TagPainter(id, 0.12).paint({pose}, lens, &light);
  GreyImage grey(lens.width_px, lens.height_px);
  for (std::size_t i = 0; i < grey.data().size(); ++i)
    grey.data()[i] = static_cast<std::uint8_t>(light.data()[i] + 0.5f);
  return grey;
}

}  // namespace cyclorama
