// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/panorama_texture.h"

namespace cyclorama::display {

/// Makes a frame's light ready for a bilinear filter, once per frame: a pixel is sharpened by as much as the filter
/// softens on average over all places between pixels. That takes a fraction of what a sharp filter takes at every
/// refresh, and gives two thirds of its gain (docs/design/walking.md). Source: Blu, Thevenaz and Unser, "Linear
/// Interpolation Revitalized", IEEE Transactions on Image Processing 13(5), 2004, for filters before interpolation.
///
/// Thread-bound to the GL context; borrows the Gl table.
class LightSharpener {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<LightSharpener> make(const output::Gl& gl, Texels texels);

  /// Draws the sharpened() light of `panorama` from its light(). Errors: kSystem if the driver cannot draw it.
  Status draw(PanoramaTexture* panorama) const;

 private:
  LightSharpener(const output::Gl& gl, output::GlProgram program);

  const output::Gl* gl_;
  output::GlProgram program_;
  // The vertex shader computes the corners from their numbers; GL still requires a bound array.
  output::GlVertexArray nothing_;
  GLint place_ = -1;
  GLint ends_ = -1;
  GLint from_ = -1;
};

}  // namespace cyclorama::display
