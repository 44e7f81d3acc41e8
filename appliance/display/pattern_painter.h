// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "drivers/output/gl_objects.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Pictures straight onto heads: each pixel's code value is the pattern's. Thread-bound to the GL context; borrows the
/// Gl table.
class PatternPainter {
 public:
  /// kSystem  the driver's compiler refuses the shader, and why.
  static Result<PatternPainter> make(const output::Gl& gl, const std::vector<output::HeadMode>& heads);

  /// What draw() shows on that head from now on. The first one of a head makes the card allocate its texture, later
  /// ones nothing. Precondition: it has the head's size.
  void upload(std::size_t head, const RgbaImage& picture);
  /// Into the bound framebuffer, which is that head's. Precondition: one was uploaded.
  void draw(std::size_t head) const;

 private:
  PatternPainter(const output::Gl& gl, output::GlProgram program) : gl_(&gl), program_(std::move(program)), nothing_(gl) {}
  struct Head {
    output::GlTexture texture;
    int width_px = 0;
    int height_px = 0;
    bool has_storage = false;
  };
  const output::Gl* gl_;
  output::GlProgram program_;
  output::GlVertexArray nothing_;  // The corners come from their numbers; GL wants an array to be bound all the same.
  GLint last_row_ = -1;
  std::vector<Head> heads_;
};

}  // namespace cyclorama::display
