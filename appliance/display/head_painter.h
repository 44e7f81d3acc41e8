// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "appliance/display/head_upload.h"
#include "appliance/display/panorama_texture.h"

namespace cyclorama::display {

/// Which texels the heads' pictures may have for each code value of 8 bits to be right within one: packed ones where a
/// processor draws, and does so quickest with them, unless a head's matrix, black or response needs more.
[[nodiscard]] Texels texels_for(const output::Gl& gl, const std::vector<HeadPlan>& plans);

/// A picture, and how far the visitor has turned to the right since it was asked for: a panorama moves to the left by
/// as much, and in the others each place moves as turned() in common/geometry/picture_place.h says.
struct TurnedPicture {
  const PanoramaTexture* picture = nullptr;
  double yaw_shift_rad = 0.0;
};

/// Draws the picture for one projector: pass 2. Thread-bound to the GL context; borrows the Gl table and the programs.
class HeadPainter {
 public:
  /// For pictures with such texels. Where `programs` has what is needed, only the driver allocates.
  /// kSystem  the graphics card refused them.
  static Result<HeadPainter> make(const output::Gl& gl, HeadPrograms* programs, const HeadUpload& upload, Texels texels);
  static Result<HeadPainter> make(const output::Gl& gl, HeadPrograms* programs, const HeadPlan& plan, Texels texels) {
    return make(gl, programs, HeadUpload(plan), texels);
  }

  /// The plan's, until another device hangs there. Precondition: in [1, 16].
  void set_depth(int depth_bits);

  /// Into the bound framebuffer. What the warp leaves out becomes black. Positions beyond the picture show its edge; in a
  /// panorama of a whole turn there is no beyond. A head for two eyes shows both, or `now` where they take turns; a
  /// picture for one eye is shown to both. Precondition: the pictures have the plan's places.
  void draw(const TurnedPicture& shown, Eye now = Eye::kLeft) const;
  /// The same of two pictures, mixed in linear light: `fade` in [0, 1] is how much of `other` is seen.
  void draw(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now = Eye::kLeft) const;
  /// The same upon what was drawn there, for blending.
  void draw_over(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now) const;
  /// Draws with every program once: drivers compile when one is first used.
  void warm_up(const TurnedPicture& shown, const TurnedPicture& other, const std::function<void()>& stepped) const;
  /// Whether what it draws depends on whose turn it is.
  [[nodiscard]] bool takes_turns() const { return packing_ == StereoPacking::kFrameSequential; }

 private:
  /// Triangles that need the same. A mask that is 1 everywhere in a triangle is not looked at.
  struct Part {
    /// By whether the picture's edges must be looked after, and whether two are mixed.
    std::array<std::array<const HeadProgram*, 2>, 2> programs{};
    GLsizei first = 0;  ///< Index.
    GLsizei count = 0;
  };
  HeadPainter(const output::Gl& gl, const HeadUpload& upload, Texels texels);
  void upload_triangles(const HeadUpload& upload);
  void upload_textures(const HeadUpload& upload);
  void clear() const;
  /// `edges`: whether the pictures' edges must be looked after.
  void draw(const TurnedPicture& shown, const TurnedPicture* other, double fade, bool edges, Eye now) const;
  void draw_for(Eye eye, const TurnedPicture& shown, const TurnedPicture* other, double fade, bool edges) const;
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
  std::array<Part, 2> parts_;  // Wholly lit, masked.
};

}  // namespace cyclorama::display
