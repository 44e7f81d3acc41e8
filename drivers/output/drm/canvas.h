// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/output/gl_objects.h"

namespace cyclorama::output {

/// Clockwise rotation of a head's picture on its panel.
enum class Rotation { kNone, kQuarter, kHalf, kThreeQuarters };

/// The picture of one head before it is turned and scaled to its mode. It keeps the newest picture whether or not a
/// projector is connected, at the installation's size, so that a projector that returns shows it at once. 10 bits per
/// primary. Move-only; bound to its GL context.
class Canvas {
 public:
  /// Makes a black canvas. Errors: kInvalidArgument if the driver cannot draw that size; kUnavailable if it cannot draw
  /// 10 bits.
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

/// Copies a canvas to a scan-out buffer: rotates it, flips its rows, and scales it if the sizes differ. Bound to its GL
/// context, whose program, textures, framebuffer, vertex array and viewport it changes.
class CanvasCopier {
 public:
  /// Errors: kSystem if the driver's compiler rejects the shader, with its log.
  static Result<CanvasCopier> make(const Gl& gl);

  struct Target {
    GLuint framebuffer = 0;  ///< Row 0 is the top of the picture.
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
