// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "appliance/display/caption.h"
#include "appliance/display/head_upload.h"
#include "appliance/display/panorama_texture.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::display {

/// Returns the fastest texel format that keeps every 8-bit code value correct within one: kPacked on a software
/// renderer, unless a head's depth, matrix, black lift or response needs more; else kHalves.
[[nodiscard]] Texels texels_for(const output::Gl& gl, const std::vector<HeadPlan>& plans);

/// A picture, and how far the visitor has turned to the right since its view was requested. A panorama moves to the
/// left by the same angle; in the other projections each position moves as turned() in common/geometry/picture_place.h
/// computes.
struct TurnedPicture {
  const PanoramaTexture* picture = nullptr;
  double yaw_shift_rad = 0.0;
};

/// Draws the picture for one projector: pass 2. Thread-bound to the GL context; borrows the Gl table and the programs.
class HeadPainter {
 public:
  /// Makes a painter for pictures in the format `texels`. If `programs` already holds the programs that it needs, only
  /// the driver allocates. Errors: kSystem if the graphics card refuses the textures or buffers.
  static Result<HeadPainter> make(const output::Gl& gl, HeadPrograms* programs, const HeadUpload& upload,
                                  Texels texels);
  static Result<HeadPainter> make(const output::Gl& gl, HeadPrograms* programs, const HeadPlan& plan, Texels texels) {
    return make(gl, programs, HeadUpload(plan), texels);
  }

  /// Replaces the plan's number of bits per code value, after another device was connected. Precondition: in [1, 16].
  void set_depth(int depth_bits);

  /// Prepares for drawing a caption; null: there is none. The first caption makes a program, and the driver may need
  /// time for it. Errors: kSystem if the driver's compiler refuses it.
  Status set_caption(HeadPrograms* programs, const Caption* caption);

  /// Draws into the bound framebuffer. Pixels without a position in the warp become black. Positions beyond the picture
  /// show its edge; a panorama of a whole turn has no edge in azimuth. A stereo head shows both eyes' pictures, or only
  /// that of `now` if the eyes alternate; a picture for one eye is shown to both. Precondition: the pictures have the
  /// kind and tilt of the plan's picture; `caption`, which may be null, is the one of set_caption().
  void draw(const TurnedPicture& shown, Eye now = Eye::kLeft, const ShownCaption* caption = nullptr) const;
  /// Draws two pictures, mixed in linear light: `fade` in [0, 1] is the share of `other`.
  void draw(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now = Eye::kLeft,
            const ShownCaption* caption = nullptr) const;
  /// Draws like draw() with `fade`, but blends the result over the framebuffer's content.
  void draw_over(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now,
                 const ShownCaption* caption = nullptr) const;
  /// Draws with every program once, because drivers compile a program when it is first used.
  void warm_up(const TurnedPicture& shown, const TurnedPicture& other, const std::function<void()>& stepped) const;
  /// True if the eyes alternate, so that the drawing depends on the refresh.
  [[nodiscard]] bool takes_turns() const { return packing_ == StereoPacking::kFrameSequential; }

 private:
  /// Triangles drawn with the same programs. Triangles on which the mask is 1 everywhere do not sample it.
  struct Part {
    /// Indexed by whether the picture's edges must be respected, and whether two pictures are mixed.
    std::array<std::array<const HeadProgram*, 2>, 2> programs{};
    GLsizei first = 0;  ///< Position of the part's first index in the index buffer.
    GLsizei count = 0;
  };
  HeadPainter(const output::Gl& gl, const HeadUpload& upload, Texels texels);
  void upload_triangles(const HeadUpload& upload);
  void upload_textures(const HeadUpload& upload);
  void clear() const;
  /// One drawing of the whole head, or of the part that the caption covers.
  struct Pass {
    const TurnedPicture* shown = nullptr;
    const TurnedPicture* other = nullptr;  ///< Null: one picture.
    double fade = 0.0;
    bool edges = false;                     ///< The pictures' edges must be respected.
    const ShownCaption* caption = nullptr;  ///< Null: without it.
    bool is_cut = false;                    ///< Only the part that the caption covers.
  };
  /// Draws the head, and then once more what the caption covers, with it.
  void draw_both(const Pass& pass, Eye now, const ShownCaption* caption) const;
  void draw(const Pass& pass, Eye now) const;
  void draw_for(Eye eye, const Pass& pass, int x_px, int y_px) const;
  void use_caption(const HeadProgram& program, const TurnedPicture& shown, Eye eye, const ShownCaption& caption) const;
  void use(const HeadProgram& program, const TurnedPicture& shown, const TurnedPicture* other, double fade,
           Eye eye) const;

  const output::Gl* gl_;
  int width_px_;
  int height_px_;
  PictureShape picture_;
  std::optional<StereoPacking> packing_;
  warp::HeadColour colour_;
  float code_step_ = 0.0f;
  output::GlVertexArray mesh_;
  output::GlBuffer vertices_;
  output::GlBuffer indices_;
  output::GlTexture mask_;
  output::GlTexture map_;
  output::GlTexture response_;
  Texels texels_;
  std::array<Part, 2> parts_;                     // Fully lit triangles, then those that need the mask.
  HeadFeatures features_;                         // Features that all parts have.
  HeadUpload::Grid grid_;                         // Copy of HeadUpload::grid.
  const HeadProgram* caption_program_ = nullptr;  // Null before the first caption.
  Eigen::Matrix3d to_caption_ = Eigen::Matrix3d::Identity();
  PixelRect caption_box_;  // Pixels of the head around the caption, in rows from the bottom; empty: there is none.
  Eigen::Vector2d caption_size_ = Eigen::Vector2d::Ones();
};

}  // namespace cyclorama::display
