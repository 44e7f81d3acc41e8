// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "appliance/display/frame_reuse.h"
#include "appliance/display/reprojection_painter.h"

namespace cyclorama::display {

/// Everything before pass 2: the newest frame's light, with what earlier frames showed of the same surfaces
/// (frame_reuse.h), seen from the visitor's eye (reprojection_painter.h). A frame that comes from the eye and heading of
/// the one before, or without depth, is shown exactly as it came, and so is any first frame.
///
/// Thread-bound to the GL context; borrows the Gl table and the program.
class FrameLight {
 public:
  /// Errors: kSystem if the driver's compiler refuses a shader, with its message.
  static Result<FrameLight> make(const output::Gl& gl, const PictureProgram& program, Texels texels, MeshFilter filter);

  /// Uses each shader once, on a few pixels, because drivers compile a shader at its first use.
  Status warm_up(const PictureShape& shape);
  /// Takes a new frame, and shows it from its own eye. Errors: kSystem if the graphics card refuses the picture.
  Status take(const DisplayFrame& frame);
  /// Shows the newest frame from an eye that has moved by `eye_m` (ReprojectionMesh::move()); zero: from its own.
  /// Precondition: take(frame) was the last; frame.mesh is set unless the move is zero. Errors: likewise.
  Status move(const DisplayFrame& frame, const Eigen::Vector3d& eye_m);
  /// Lets the next frame be shown as it comes.
  void forget() { reuse_.forget(); }

  [[nodiscard]] const PanoramaTexture& panorama() const { return panorama_; }
  [[nodiscard]] const ReprojectionPainter& reprojection() const { return reprojection_; }

 private:
  FrameLight(const output::Gl& gl, const PictureProgram& program, ReprojectionPainter reprojection, FrameReuse reuse)
      : panorama_(gl, program), reprojection_(std::move(reprojection)), reuse_(std::move(reuse)) {}

  PanoramaTexture panorama_;
  ReprojectionPainter reprojection_;
  FrameReuse reuse_;
};

}  // namespace cyclorama::display
