// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "appliance/display/head_program.h"
#include "appliance/display/panorama_texture.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "appliance/warp/pixel_map.h"
#include "common/room/stereo.h"

namespace cyclorama {

/// What one projector needs: where its pixels lie, how bright they may be, and which code values make its light. With
/// two eyes all this is said of the pixels that one eye gets of the head (lens_of_an_eye()), and holds for both: a
/// pixel lights one place of the wall, whichever eye's picture it shows there.
struct HeadPlan {
  Warp warp;
  MaskImage mask;       ///< Of the head's size.
  HeadColour colour{};  ///< A lift has the head's size.
  int depth_bits = 8;   ///< Of the output's code values, each channel.
  bool is_dithered = true;
  PictureShape picture = Panorama{};       ///< Which places the warp tells: only its kind and tilt count.
  std::optional<StereoPacking> packing{};  ///< Nothing: one eye's picture; of two, the left eye's.
};

/// Which texels the heads' pictures may have for each code value of 8 bits to be right within one: packed ones where a
/// processor draws, and does so quickest with them, unless a head's matrix, black or response needs more.
[[nodiscard]] Texels texels_for(const Gl& gl, const std::vector<HeadPlan>& plans);

/// A picture, and how far the visitor has turned to the right since it was asked for: a panorama moves to the left by
/// as much, and in the others each place moves as turned() in common/geometry/picture_place.h says.
struct TurnedPicture {
  const PanoramaTexture* picture = nullptr;
  double yaw_shift_rad = 0.0;
};

/// Draws the picture for one projector: pass 2. Thread-bound to the GL context; borrows the Gl table and the programs.
class HeadPainter {
 public:
  /// For pictures with such texels. Precondition: the plan's pictures have one size, its response is valid, its picture
  /// is not equirectangular. kSystem  the graphics card refused them.
  static Result<HeadPainter> make(const Gl& gl, HeadPrograms* programs, const HeadPlan& plan, Texels texels);

  /// The plan's, until another device hangs there. Precondition: in [1, 16].
  void set_depth(int depth_bits);

  /// Into the bound framebuffer. What the warp leaves out becomes black. Places beyond the picture show its edge; in a
  /// panorama of a whole turn there is no beyond. A head for two eyes shows both, or `now` where they take turns; a
  /// picture for one eye is shown to both. Precondition: the pictures have the plan's places.
  void draw(const TurnedPicture& shown, Eye now = Eye::kLeft) const;
  /// The same of two pictures, mixed in linear light: `fade` in [0, 1] is how much of `other` is seen.
  void draw(const TurnedPicture& shown, const TurnedPicture& other, double fade, Eye now = Eye::kLeft) const;
  /// Draws with every program once: drivers compile when one is first used.
  void warm_up(const TurnedPicture& shown, const TurnedPicture& other) const;
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
  HeadPainter(const Gl& gl, const HeadPlan& plan, Texels texels);
  void upload_triangles(const std::vector<float>& corners, const std::vector<std::uint32_t>& indices,
                        bool has_terms = false);
  void upload_textures(const HeadPlan& plan);
  /// `edges`: whether the pictures' edges must be looked after.
  void draw(const TurnedPicture& shown, const TurnedPicture* other, double fade, bool edges, Eye now) const;
  void draw_for(Eye eye, const TurnedPicture& shown, const TurnedPicture* other, double fade, bool edges) const;
  void use(const HeadProgram& program, const TurnedPicture& shown, const TurnedPicture* other, double fade,
           Eye eye) const;

  const Gl* gl_;
  int width_px_;
  int height_px_;
  PictureShape picture_;
  std::optional<StereoPacking> packing_;
  HeadColour colour_;
  float code_step_ = 0.0f;
  GlVertexArray mesh_;
  GlBuffer vertices_;
  GlBuffer indices_;
  GlTexture mask_;
  GlTexture map_;
  GlTexture response_;
  Texels texels_;
  std::array<Part, 2> parts_;  // Wholly lit, masked.
};

}  // namespace cyclorama
