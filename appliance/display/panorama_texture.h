// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/frame.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama {

/// Pass 1: the newest frame's picture as a texture. Thread-bound to the GL context; borrows the Gl table.
class PanoramaTexture {
 public:
  explicit PanoramaTexture(const Gl& gl);

  /// Precondition: frame.picture is set and has the size of frame.panorama.
  /// kSystem  the graphics card refused it (too large); the old picture may be lost.
  Status upload(const Frame& frame);

  [[nodiscard]] GLuint id() const { return texture_.id(); }
  [[nodiscard]] const Panorama& panorama() const { return panorama_; }

 private:
  const Gl& gl_;
  GlTexture texture_;
  Panorama panorama_;
};

}  // namespace cyclorama
