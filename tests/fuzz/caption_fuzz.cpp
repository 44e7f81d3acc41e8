// SPDX-License-Identifier: Apache-2.0
/// Captions on the Show stream.
#include <cstddef>
#include <cstdint>

#include "appliance/display/caption.h"

using namespace cyclorama;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wire::Caption message;
  if (!message.ParseFromArray(data, static_cast<int>(size))) return 0;
  const auto caption = display::caption_of(message);
  if (!caption || caption->ink.empty()) return 0;
  for (const PictureShape& shape :
       {PictureShape(Panorama{64, 32, 2.0, 0.5, -0.5}), PictureShape(Fisheye{64, 64, 3.0, 0.5}),
        PictureShape(Perspective{64, 32, -1.0, 1.0, 0.5, -0.5, 0.2})}) {
    CHECK(display::to_caption(shape, *caption).allFinite());
  }
  return 0;
}
