// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/frame_light.h"

#include "common/geometry/picture_place.h"

namespace cyclorama::display {

Result<FrameLight> FrameLight::make(const output::Gl& gl, const PictureProgram& program, Texels texels,
                                    MeshFilter filter) {
  TRY_ASSIGN(ReprojectionPainter reprojection, ReprojectionPainter::make(gl, texels, filter));
  TRY_ASSIGN(FrameReuse reuse, FrameReuse::make(gl, texels));
  TRY_ASSIGN(RefinementFade fade, RefinementFade::make(gl, texels));
  return FrameLight(gl, program, std::move(reprojection), std::move(reuse), std::move(fade));
}

Status FrameLight::warm_up(const PictureShape& shape) {
  constexpr int kSide_px = 32;
  DisplayFrame frame;
  frame.shape = with_pixels(shape, kSide_px, kSide_px);
  frame.picture = std::make_shared<const PlanarPicture>(kSide_px, kSide_px, true);
  frame.mesh = std::make_shared<const ReprojectionMesh>(
      std::make_shared<const ReprojectionGrid>(Projection{frame.shape, {}}, kSide_px),
      InverseDepthImage(1, 1, inverse_depth_of(1.0f)));
  const Eigen::Vector3d beside_m(0.1, 0.0, 0.0);
  TRY(take(frame));
  TRY(take(frame));
  frame.eye_m = beside_m;
  TRY(take(frame));
  TRY(move(frame, beside_m));
  forget();
  return Done{};
}

Status FrameLight::take(const DisplayFrame& frame) {
  const bool reuses = reuse_.is_useful_for(frame);
  const bool refines = reuse_.is_refined_by(frame);
  const PictureShape before = panorama_.shape();
  if (refines && is_fading()) panorama_.take_drawn();  // The fade goes on from what is shown.
  former_.reset();
  if (reuses || refines) panorama_.keep();
  TRY(panorama_.upload(frame));
  if (reuses) TRY(reuse_.add_earlier(frame, &panorama_));
  TRY(reuse_.remember(frame));
  if (!refines) return Done{};
  former_ = before;
  return fade(0.0);
}

Status FrameLight::fade(double share) {
  CHECK(is_fading());
  if (share < 1.0) return fade_.draw(*former_, share, &panorama_);
  former_.reset();
  panorama_.show_unmoved();
  return Done{};
}

Status FrameLight::move(const DisplayFrame& frame, const Eigen::Vector3d& eye_m) {
  former_.reset();
  if (!eye_m.isZero(0.0)) return reprojection_.draw(*frame.mesh, eye_m, &panorama_);
  panorama_.show_unmoved();
  return Done{};
}

}  // namespace cyclorama::display
