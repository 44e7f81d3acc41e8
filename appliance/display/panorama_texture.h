// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

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
  // The vertex shader computes the corners from the vertices' indices, but GL still requires a bound array.
  output::GlVertexArray nothing_;
  GLint place_ = -1;
  GLint luma_ = -1;
  GLint chroma_ = -1;
  GLint chroma_end_ = -1;
};

/// Pass 1, once per frame: the newest frame's picture as a texture of light. The texture has an additional column on
/// each side of the picture: for a whole turn, a copy of the column at the opposite side; otherwise a copy of the edge
/// column, so that clamping repeats it.
///
///     planes ──upload()──▶ light() ──▶ sharpened() ──ReprojectionPainter──▶ moved ──▶ id(), for pass 2
///                           │  ▲ └───────────────── at its own eye ───────────────────▲
///                    keep() ▼  │ FrameReuse                                            │
///                         earlier() ──────────────RefinementFade───────────────────────┘
///
/// The textures grow to the largest picture and never shrink: a picture of a former size allocates nothing.
/// Thread-bound to the GL context; borrows the Gl table and the program.
class PanoramaTexture {
 public:
  PanoramaTexture(const output::Gl& gl, const PictureProgram& program);

  /// Converts `frame` and leaves one of its framebuffers bound. Precondition: frame.picture is set and contains
  /// frame.stacked pictures of frame.shape's size, one above another; if there are two, each has an even height.
  /// Errors: kSystem if the graphics card refuses the picture (for example, too large); the former picture may then be
  /// lost.
  Status upload(const DisplayFrame& frame);
  /// Converts the planes of the newest frame again. Precondition: the last upload() was of `frame`.
  void convert(const DisplayFrame& frame) const;
  /// Shows light() itself again, after another pass had drawn it from another eye.
  void show_unmoved() { is_moved_ = false; }

  [[nodiscard]] GLuint id() const { return shown().texture.id(); }
  [[nodiscard]] Texels texels() const { return program_->texels_; }
  /// Shape of one eye's picture.
  [[nodiscard]] const PictureShape& shape() const { return shape_; }
  /// Number of eyes' pictures; 2: the right eye's lies below the left eye's.
  [[nodiscard]] int stacked() const { return stacked_; }
  /// Size of the texture in pixels. The picture's first column is column 1 of the texture.
  [[nodiscard]] int texture_width() const { return shown().width; }
  [[nodiscard]] int texture_height() const { return shown().height; }
  static constexpr int kFirstColumn = 1;

  // The rest serves passes between pass 1 and pass 2 (reprojection_painter.h, frame_reuse.h):

  struct Light {
    output::GlTexture texture;
    output::GlFramebuffer target;
    int width = 0;  ///< Width of the texture; the picture is in its upper left corner.
    int height = 0;
  };
  /// The newest frame's light from its own eye.
  [[nodiscard]] const Light& light() const { return light_; }
  /// Keeps the newest frame's light as earlier(); to be called before the next upload().
  void keep() { std::swap(light_, earlier_); }
  [[nodiscard]] const Light& earlier() const { return earlier_; }
  /// Binds a framebuffer with a depth buffer, of light()'s size, to draw the same frame from another eye; from now on
  /// the result is shown. Errors: kSystem if the driver cannot draw into it.
  Status bind_moved();
  /// Binds the framebuffer of drawn(), at least of light()'s size, to draw the same frame again; take_drawn() makes the
  /// result the frame's light. Errors: kSystem if the driver cannot draw into it.
  Status bind_drawn();
  [[nodiscard]] const Light& drawn() const { return moved_; }
  /// Shows drawn() until the next upload(), move or show_unmoved().
  void show_drawn() { is_moved_ = true; }
  void take_drawn() {
    std::swap(light_, moved_);
    is_sharpened_ = false;
  }
  /// light(), made ready for a bilinear filter (light_sharpener.h); once bind_sharpened() was called since the
  /// light changed, and a pass drew it.
  [[nodiscard]] const Light& sharpened() const { return sharpened_; }
  [[nodiscard]] bool is_sharpened() const { return is_sharpened_; }
  /// Binds the framebuffer of sharpened(), at least of light()'s size. Errors: kSystem if the driver cannot draw so.
  Status bind_sharpened();

 private:
  struct Plane {
    output::GlTexture texture;
    int width = 0;  ///< Width of the texture; the picture is in its upper left corner.
    int height = 0;
  };
  static constexpr GLint kLumaUnit = 0;
  static constexpr GLint kBlueUnit = 1;
  static constexpr GLint kRedUnit = 2;
  friend class PictureProgram;
  [[nodiscard]] Light make_light() const;
  Status grow(int width, int height, Light* light);
  [[nodiscard]] const Light& shown() const { return is_moved_ ? moved_ : light_; }
  void bind_planes() const;
  void upload(const GreyImage& pixels, const PixelRect& part, Plane* ret_plane);
  void draw(const PixelRect& part, int moved_px, int chroma_step) const;

  const output::Gl* gl_;
  const PictureProgram* program_;
  Plane luma_;
  Plane blue_;
  Plane red_;
  Light light_;
  Light earlier_;    // Empty until keep().
  Light moved_;      // Empty until bind_moved() or bind_drawn().
  Light sharpened_;  // Empty until bind_sharpened().
  bool is_moved_ = false;
  bool is_sharpened_ = false;
  output::GlRenderbuffer depth_;  // Has no storage until bind_moved().
  int depth_width_ = 0;
  int depth_height_ = 0;
  int chroma_step_ = 1;
  PictureShape shape_;
  int stacked_ = 1;
};

}  // namespace cyclorama::display
