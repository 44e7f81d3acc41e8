// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/frame.h"
#include "appliance/display/texels.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// Pass 1's shader, shared by all pictures of a context: luma and chroma to linear light.
class PictureProgram {
 public:
  /// kSystem  the driver's compiler refuses the shader, and why.
  static Result<PictureProgram> make(const output::Gl& gl, Texels texels);

 private:
  friend class PanoramaTexture;
  PictureProgram(output::GlProgram program, Texels texels) : program_(std::move(program)), texels_(texels) {}
  output::GlProgram program_;
  Texels texels_;
  output::GlVertexArray nothing_;  // The corners come from their numbers; GL wants an array to be bound all the same.
  GLint place_ = -1;
  GLint luma_ = -1;
  GLint chroma_ = -1;
  GLint chroma_end_ = -1;
};

/// Pass 1, once per frame: the newest frame's picture as a texture of light. It has a column more on each side of the
/// picture: of a whole turn, the other side's; else the same once more, so that clamping there repeats it.
///
/// The textures grow to the largest picture and never shrink: a picture of a size that was there before allocates
/// nothing. Thread-bound to the GL context; borrows the Gl table and the program.
class PanoramaTexture {
 public:
  PanoramaTexture(const output::Gl& gl, const PictureProgram& program);

  /// Binds a framebuffer of its own. Precondition: frame.picture is set and has the size of frame.shape, frame.stacked
  /// times one above another; then each has a height that is a multiple of two.
  /// kSystem  the graphics card refused it (too large); the old picture may be lost.
  Status upload(const DisplayFrame& frame);

  [[nodiscard]] GLuint id() const { return light_.id(); }
  [[nodiscard]] Texels texels() const { return program_->texels_; }
  /// Of one eye's picture.
  [[nodiscard]] const PictureShape& shape() const { return shape_; }
  /// 2: below it is the right eye's.
  [[nodiscard]] int stacked() const { return stacked_; }
  /// Of the texture, in pixels; the picture's first column is column 1 of it.
  [[nodiscard]] int texture_width() const { return width_; }
  [[nodiscard]] int texture_height() const { return height_; }
  static constexpr int kFirstColumn = 1;

 private:
  struct Plane {
    output::GlTexture texture;
    int width = 0;
    int height = 0;
  };
  Status grow(int width, int height);
  void upload(const GreyImage& pixels, const PixelRect& part, Plane* ret_plane);
  void draw(const PixelRect& part, int moved_px, int chroma_step) const;

  const output::Gl* gl_;
  const PictureProgram* program_;
  Plane luma_;
  Plane blue_;
  Plane red_;
  output::GlTexture light_;
  output::GlFramebuffer target_;
  int width_ = 0;
  int height_ = 0;
  PictureShape shape_;
  int stacked_ = 1;
};

}  // namespace cyclorama::display
