// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/walk/shown_wall.h"

#include "appliance/display/eye_move.h"
#include "appliance/display/yaw_shift.h"
#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"
#include "drivers/output/headless/headless_output.h"

namespace cyclorama {

Result<std::unique_ptr<ShownWall>> ShownWall::make(const PictureShape& wall,
                                                   std::optional<display::MeshFilter> chosen) {
  std::unique_ptr<ShownWall> shown(new ShownWall(wall));
  const int width = width_px(wall);
  const int height = height_px(wall);
  TRY_ASSIGN(shown->output_, output::open_headless_output({{{"wall", width, height}}, 240.0, {}, {}}, shown->clock_));
  const output::Gl& gl = shown->output_->gl();
  gl.Disable(GL_DITHER);
  shown->renderer_ = gl.renderer();
  display::HeadPlan plan;
  plan.picture = wall;
  plan.mask = warp::MaskImage(width, height, 1.0f);
  const PixelScale scale = pixel_scale(wall);
  warp::WarpMesh mesh{width, height, 1, 1, {}, 0.0};
  for (const double v : {0.0, 1.0 * height}) {
    for (const double u : {0.0, 1.0 * width}) {
      const PicturePlace place = scale.place_at({u, v});
      mesh.vertices.push_back({static_cast<float>(u), static_cast<float>(v), static_cast<float>(place.across),
                               static_cast<float>(place.up)});
    }
  }
  plan.warp = mesh;
  const display::MeshFilter filter = chosen.value_or(display::mesh_filter_for(gl));
  const bool is_of_card = filter == display::MeshFilter::kSharp;
  const display::Texels texels = is_of_card ? display::Texels::kHalves : display::texels_for(gl, {plan});
  TRY_ASSIGN(display::PictureProgram program, display::PictureProgram::make(gl, texels));
  shown->program_.emplace(std::move(program));
  shown->programs_.emplace(gl);
  TRY_ASSIGN(display::HeadPainter painter, display::HeadPainter::make(gl, &*shown->programs_, plan, texels));
  shown->painter_.emplace(std::move(painter));
  TRY_ASSIGN(display::FrameLight light, display::FrameLight::make(gl, *shown->program_, texels, filter));
  shown->light_.emplace(std::move(light));
  return shown;
}

Status ShownWall::take(const display::DisplayFrame& frame, bool reuses) {
  frame_ = frame;
  if (!reuses) light_->forget();
  return light_->take(frame_);
}

Status ShownWall::draw_for(const Eigen::Vector3d& eye_m, double heading_rad, bool moves) {
  const display::EyeMove move = display::eye_move(frame_.eye_m, frame_.heading_rad, eye_m);
  TRY(light_->move(frame_, moves && frame_.mesh != nullptr ? move.eye_m : Eigen::Vector3d::Zero()));
  const double limit = turn_reach(frame_.shape, wall_);
  TRY(output_->draw_to(0));
  painter_->draw({&light_->panorama(), display::yaw_shift(frame_.heading_rad, heading_rad, limit).angle_rad});
  return output_->gl().check("drawing the wall");
}

Result<RgbImage> ShownWall::shown(const Eigen::Vector3d& eye_m, double heading_rad, bool moves) {
  TRY(draw_for(eye_m, heading_rad, moves));
  RgbaImage read_back(width_px(wall_), height_px(wall_));
  output_->gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
  output_->gl().ReadPixels(0, 0, read_back.width(), read_back.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                           read_back.data().data());
  TRY(output_->gl().check("reading the wall back"));
  RgbImage picture(read_back.width(), read_back.height());
  output::to_picture(read_back, &picture);
  return picture;
}

Status ShownWall::convert(const Eigen::Vector3d& eye_m) {
  if (eye_m.isZero(0.0)) {
    light_->panorama().convert(frame_);
  } else {
    TRY(light_->move(frame_, eye_m));
  }
  return finish();
}

Status ShownWall::finish() {
  output_->gl().Finish();
  return output_->gl().check("drawing a frame");
}

}  // namespace cyclorama
