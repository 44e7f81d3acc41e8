// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

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

/// Beginning of a fragment shader that writes light: the version, `extensions`, and light_shader.h.
[[nodiscard]] std::string light_shader_header(Texels texels, const char* extensions = "");
/// Sets the texture units from which a program with that header reads the planes; PanoramaTexture::bind_planes() binds
/// them there.
void select_planes(const output::Gl& gl, const output::GlProgram& program);

/// Pass 1, once per frame: the newest frame's picture as a texture of light. It has an additional column on each side
/// of the picture: for a whole turn, the column at the opposite side; otherwise a copy of the edge column, so that
/// clamping repeats it.
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
  /// Converts the newest frame again, after another pass drew over its light. Precondition: upload(frame) was the last.
  void show_unmoved(const DisplayFrame& frame) const;

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

  // Access for the other pass 1 (reprojection_painter.h):

  static constexpr GLint kLumaUnit = 0;
  static constexpr GLint kBlueUnit = 1;
  static constexpr GLint kRedUnit = 2;
  struct Plane {
    output::GlTexture texture;
    int width = 0;  ///< The texture's width; the picture is in its upper left corner.
    int height = 0;
  };
  void bind_planes() const;
  /// Binds the framebuffer of the light with a depth buffer. Errors: kSystem if the driver cannot draw into it.
  Status bind_with_depth();
  [[nodiscard]] const Plane& luma() const { return luma_; }
  [[nodiscard]] const Plane& chroma() const { return blue_; }
  [[nodiscard]] int chroma_step() const { return chroma_step_; }  ///< Pixels per pixel of chroma: 1 or 2.

 private:
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
  output::GlRenderbuffer depth_;  // Has no storage until bind_with_depth().
  int depth_width_ = 0;
  int depth_height_ = 0;
  int chroma_step_ = 1;
  int width_ = 0;
  int height_ = 0;
  PictureShape shape_;
  int stacked_ = 1;
};

}  // namespace cyclorama::display
