// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/panorama_texture.h"

namespace cyclorama::display {

/// Mixes a frame with the former one, which it refines: both show the same from the same eye, with other errors. A
/// picture at rest comes in steps, and each would be seen if it came at once: the first has another size and other JPEG
/// quality than the walking picture before it.
///
/// Thread-bound to the GL context; borrows the Gl table.
class RefinementFade {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<RefinementFade> make(const output::Gl& gl, Texels texels);

  /// Draws `share` of the frame's light and the rest of earlier(), whose shape is `former`, and shows the result.
  /// Preconditions: has_same_places(former, panorama->shape()), and both have as many eyes' pictures. Errors: kSystem
  /// if the driver cannot draw it.
  Status draw(const PictureShape& former, double share, PanoramaTexture* panorama) const;

 private:
  RefinementFade(const output::Gl& gl, output::GlProgram program);

  const output::Gl* gl_;
  output::GlProgram program_;
  // The vertex shader computes the corners from their numbers; GL still requires a bound array.
  output::GlVertexArray nothing_;
  GLint place_ = -1;
  GLint share_ = -1;
  GLint from_ = -1;
  GLint earlier_per_px_ = -1;
  GLint inside_ = -1;
  GLint per_texel_ = -1;
};

}  // namespace cyclorama::display
