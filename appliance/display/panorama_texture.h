// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/frame.h"
#include "appliance/display/texels.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// Pass 1's shader, shared by all pictures of a context: converts luma and chroma to linear light.
class PictureProgram {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<PictureProgram> make(const output::Gl& gl, Texels texels);

 private:
  friend class PanoramaTexture;
  PictureProgram(output::GlProgram program, Texels texels) : program_(std::move(program)), texels_(texels) {}
  output::GlProgram program_;
  Texels texels_;
  // The vertex shader computes the corners from their numbers; GL still requires a bound array.
  output::GlVertexArray nothing_;
  GLint place_ = -1;
  GLint luma_ = -1;
  GLint chroma_ = -1;
  GLint chroma_end_ = -1;
};

/// Pass 1, once per frame: the newest frame's picture as a texture of light. It has an additional column on each side
/// of the picture: for a whole turn the opposite side's; else the edge column again, so that clamping there repeats it.
///
/// The textures grow to the largest picture and never shrink: a picture of a former size allocates nothing.
/// Thread-bound to the GL context; borrows the Gl table and the program.
class PanoramaTexture {
 public:
  PanoramaTexture(const output::Gl& gl, const PictureProgram& program);

  /// Converts `frame` and binds a framebuffer of its own. Precondition: frame.picture is set and contains frame.stacked
  /// pictures of frame.shape's size, one above another; if there are two, each has an even height. Errors: kSystem if
  /// the graphics card refuses the picture (too large); the old picture may be lost.
  Status upload(const DisplayFrame& frame);

  [[nodiscard]] GLuint id() const { return light_.id(); }
  [[nodiscard]] Texels texels() const { return program_->texels_; }
  /// Shape of one eye's picture.
  [[nodiscard]] const PictureShape& shape() const { return shape_; }
  /// Number of eyes' pictures; 2: the right eye's lies below the left eye's.
  [[nodiscard]] int stacked() const { return stacked_; }
  /// Size of the texture in pixels; the picture's first column is its column 1.
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
