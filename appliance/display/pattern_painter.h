// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "drivers/output/gl_objects.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Draws pictures straight onto heads: each pixel gets the code value of the pattern. Thread-bound to the GL context;
/// borrows the Gl table.
class PatternPainter {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<PatternPainter> make(const output::Gl& gl, const std::vector<output::HeadMode>& heads);

  /// Sets the picture that draw() shows on that head from now on. A head's first picture makes the card allocate its
  /// texture; later ones allocate nothing. Precondition: the picture has the head's size.
  void upload(std::size_t head, const RgbaImage& picture);
  /// Draws into the bound framebuffer, which belongs to that head. Precondition: a picture was uploaded.
  void draw(std::size_t head) const;

 private:
  PatternPainter(const output::Gl& gl, output::GlProgram program)
      : gl_(&gl), program_(std::move(program)), nothing_(gl) {}
  struct Head {
    output::GlTexture texture;
    int width_px = 0;
    int height_px = 0;
    bool has_storage = false;
  };
  const output::Gl* gl_;
  output::GlProgram program_;
  // The vertex shader computes the corners from the vertices' indices, but GL still requires a bound array.
  output::GlVertexArray nothing_;
  GLint last_row_ = -1;
  std::vector<Head> heads_;
};

}  // namespace cyclorama::display
