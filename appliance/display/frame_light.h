// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "appliance/display/frame_reuse.h"
#include "appliance/display/refinement_fade.h"
#include "appliance/display/reprojection_painter.h"

namespace cyclorama::display {

/// All passes before pass 2: the light of the newest frame, combined with what earlier frames showed of the same
/// surfaces (frame_reuse.h), seen from the visitor's eye (reprojection_painter.h). The first frame and a frame without
/// depth are shown unchanged, and so is a frame with the eye and heading of its predecessor once it has faded in
/// (refinement_fade.h).
///
/// Thread-bound to the GL context; borrows the Gl table and the program.
class FrameLight {
 public:
  /// Errors: kSystem if the driver's compiler refuses a shader, with its message.
  static Result<FrameLight> make(const output::Gl& gl, const PictureProgram& program, Texels texels, MeshFilter filter);

  /// Runs each shader once, on a few pixels, because drivers compile a shader when it is first used.
  Status warm_up(const PictureShape& shape);
  /// Takes a new frame, and shows it from its own eye; one that refines its predecessor begins to fade in. Errors:
  /// kSystem if the graphics card refuses the picture.
  Status take(const DisplayFrame& frame);
  /// Shows the newest frame from an eye that has moved by `eye_m` (ReprojectionMesh::move()); zero: from its own eye.
  /// Precondition: the last take() was of `frame`; frame.mesh is set unless the move is zero. Errors: those of take().
  Status move(const DisplayFrame& frame, const Eigen::Vector3d& eye_m);
  /// True while the newest frame fades in.
  [[nodiscard]] bool is_fading() const { return former_.has_value(); }
  /// Shows `share` of the newest frame, and the rest of its predecessor; from 1 on it is shown unchanged. Precondition:
  /// is_fading(). Errors: those of take().
  Status fade(double share);
  /// Forgets earlier frames, so that the next frame is shown unchanged.
  void forget() {
    reuse_.forget();
    former_.reset();
  }

  [[nodiscard]] const PanoramaTexture& panorama() const { return panorama_; }
  [[nodiscard]] const ReprojectionPainter& reprojection() const { return reprojection_; }

 private:
  FrameLight(const output::Gl& gl, const PictureProgram& program, ReprojectionPainter reprojection, FrameReuse reuse,
             RefinementFade fade)
      : panorama_(gl, program),
        reprojection_(std::move(reprojection)),
        reuse_(std::move(reuse)),
        fade_(std::move(fade)) {}

  PanoramaTexture panorama_;
  ReprojectionPainter reprojection_;
  FrameReuse reuse_;
  RefinementFade fade_;
  std::optional<PictureShape> former_;  ///< Shape of the frame from which the newest one fades in, while it does.
};

}  // namespace cyclorama::display
