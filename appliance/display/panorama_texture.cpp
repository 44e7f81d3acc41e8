// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/panorama_texture.h"

namespace cyclorama {

PanoramaTexture::PanoramaTexture(const Gl& gl) : gl_(gl), texture_(gl) {
  gl_.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

Status PanoramaTexture::upload(const Frame& frame) {
  const RgbImage& picture = *frame.picture;
  CHECK(picture.width() == frame.panorama.width_px && picture.height() == frame.panorama.height_px);
  gl_.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (picture.width() == panorama_.width_px && picture.height() == panorama_.height_px) {
    gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.width(), picture.height(), GL_RGB, GL_UNSIGNED_BYTE,
                      picture.data().data());
  } else {
    // sRGB: the card turns code values into linear light as it fetches them.
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, picture.width(), picture.height(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                   picture.data().data());
  }
  panorama_ = frame.panorama;
  return gl_.check("uploading a frame");
}

}  // namespace cyclorama
