// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/panorama_texture.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/warp_mesh.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama {

/// Pass 2's shader, shared by all heads of a context. For each pixel: the warp mesh says where in the panorama it lies;
/// four texels are mixed in linear light, weighed with the blend mask, and turned into sRGB code values.
class WarpProgram {
 public:
  /// kSystem  the driver's compiler refuses the shader, and why.
  static Result<WarpProgram> make(const Gl& gl);

 private:
  friend class HeadPainter;
  explicit WarpProgram(GlProgram program) : program_(std::move(program)) {}
  GlProgram program_;
  GLint to_picture_ = -1;
  GLint size_ = -1;
};

/// Draws the panorama for one projector. Thread-bound to the GL context; borrows the Gl table and the program.
class HeadPainter {
 public:
  /// Precondition: mesh and mask have the head's size. kSystem  the graphics card refused them.
  static Result<HeadPainter> make(const Gl& gl, const WarpProgram& program, const WarpMesh& mesh,
                                  const MaskImage& mask);

  /// Into the bound framebuffer. What the mesh leaves out becomes black. `yaw_shift_rad` is how far the visitor has
  /// turned to the right since the picture was asked for: the picture moves to the left by as much. Places beyond the
  /// picture show its edge; in a panorama of a whole turn there is no beyond.
  void draw(const PanoramaTexture& picture, double yaw_shift_rad) const;

 private:
  HeadPainter(const Gl& gl, const WarpProgram& program) : gl_(&gl), program_(&program) {}

  const Gl* gl_;
  const WarpProgram* program_;
  GlVertexArray mesh_;
  GlBuffer vertices_;
  GlBuffer indices_;
  GlTexture mask_;
  GLsizei index_count_ = 0;
};

}  // namespace cyclorama
