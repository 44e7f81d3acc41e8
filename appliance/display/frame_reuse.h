// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/display/mesh_buffers.h"
#include "appliance/display/panorama_texture.h"

namespace cyclorama::display {

/// Reuses what earlier frames showed of the surfaces that a new frame shows, so that noise and stair-steps, which
/// differ between frames, average out, and no frame differs much from the one before.
///
///     earlier frames, seen from the new eye ──▶ limited to the new pixel's neighbours ──▶ 1 - share ─┐
///     new frame ────────────────────────────────────────────────────────────────────────▶   share ─▶ + ──▶ its light
///
/// The new frame's share is a quarter where the eye's move shifts nothing, and grows with the shift, since coarse depth
/// is never exact and the errors of many moves blur a texture. A pixel of the new frame is found in the earlier frames
/// by its depth. It takes nothing from an earlier frame that, by that frame's own depth, showed another surface there,
/// and nothing brighter or darker than the 3x3 new pixels around it by more than a tolerance. A false match (a mirror
/// image, another scene) therefore leaves hardly a trace in the new frame.
/// Source: Yang, Liu and Salvi, "A Survey of Temporal Antialiasing Techniques", Computer Graphics Forum 39(2), 2020.
///
/// Thread-bound to the GL context; borrows the Gl table. After the first frames of the largest size it allocates
/// nothing.
class FrameReuse {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<FrameReuse> make(const output::Gl& gl, Texels texels);

  /// True if `frame` can reuse the remembered frame: both have depth, and their eyes are less than kMaxMove_m apart.
  /// False for a frame that refines it.
  [[nodiscard]] bool is_useful_for(const DisplayFrame& frame) const;
  /// True if `frame` refines the remembered frame: both have depth, the same eye and the same heading.
  [[nodiscard]] bool is_refined_by(const DisplayFrame& frame) const;
  /// Replaces the light of `frame` in `panorama` by the mean of it and of the remembered frame's light. Preconditions:
  /// is_useful_for(frame), and `panorama` kept the remembered frame's light before it uploaded `frame`. Errors: kSystem
  /// if the graphics card refuses the buffers.
  Status add_earlier(const DisplayFrame& frame, PanoramaTexture* panorama);
  /// Keeps the parts of `frame` that the next frame reuses.
  Status remember(const DisplayFrame& frame);
  /// Forgets earlier frames, so that the next frame is shown unchanged.
  void forget() { before_.reset(); }

 private:
  [[nodiscard]] bool is_comparable(const DisplayFrame& frame) const;
  [[nodiscard]] bool is_at_rest(const DisplayFrame& frame) const;
  struct Before {
    double heading_rad = 0.0;
    Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();
    PictureShape shape;
    int stacked = 1;
  };
  struct Uniforms {
    GLint to_clip = -1;
    GLint moved_across = -1;
    GLint before_per_px = -1;
    GLint whole_turn = -1;
    GLint inside = -1;
    GLint cells_per_texel = -1;
  };
  FrameReuse(const output::Gl& gl, output::GlProgram program);

  const output::Gl* gl_;
  output::GlProgram program_;
  MeshBuffers buffers_;
  output::GlBuffer parallax_;  // Parallax, one float for each vertex.
  output::GlTexture depth_;    // Inverse depth of the remembered frame, cell by cell.
  int depth_width_ = 0;
  int depth_height_ = 0;
  int depth_cells_across_ = 0;
  int depth_cells_down_ = 0;
  Uniforms uniforms_;
  ReprojectedPicture found_;
  std::optional<Before> before_;
};

}  // namespace cyclorama::display
