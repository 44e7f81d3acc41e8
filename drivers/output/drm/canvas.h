// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/output/gl_objects.h"

namespace cyclorama::output {

/// How far a head's picture is turned clockwise on the panel that shows it.
enum class Rotation { kNone, kQuarter, kHalf, kThreeQuarters };

/// Where a head is drawn: it holds the newest picture whether a projector is there or not, at the installation's size,
/// so that whatever comes back shows it at once. 10 bits per primary. Move-only; bound to its GL context.
class Canvas {
 public:
  /// Black. kInvalidArgument  a size that the driver cannot draw.   kUnavailable  it cannot draw 10 bits.
  static Result<Canvas> make(const Gl& gl, int width_px, int height_px);

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_.id(); }
  [[nodiscard]] GLuint texture() const { return texture_.id(); }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

 private:
  GlTexture texture_;
  GlFramebuffer framebuffer_;
  int width_px_ = 0;
  int height_px_ = 0;
};

/// Puts a canvas on a scan-out buffer: turned, the right way up, and scaled where the sizes differ. Bound to its
/// context, whose program, textures, framebuffer, vertex array and viewport it changes.
class CanvasCopier {
 public:
  /// kSystem  the driver's compiler refuses the shader, and why.
  static Result<CanvasCopier> make(const Gl& gl);

  struct Target {
    GLuint framebuffer = 0;  ///< Its row 0 is the picture's top.
    int width_px = 0;
    int height_px = 0;
  };
  void copy(const Canvas& from, Rotation rotation, const Target& to) const;

 private:
  CanvasCopier(const Gl& gl, GlProgram program) : gl_(&gl), program_(std::move(program)), no_attributes_(gl) {}

  const Gl* gl_;
  GlProgram program_;
  GlVertexArray no_attributes_;
  GLint s_ = -1;
  GLint t_ = -1;
};

}  // namespace cyclorama::output
