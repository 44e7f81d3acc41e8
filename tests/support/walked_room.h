// SPDX-License-Identifier: Apache-2.0
/// A small world that can be seen from any eye, and a display's drawings of frames of it; for tests of reprojected
/// pictures.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "appliance/display/frame_light.h"
#include "appliance/display/head_painter.h"
#include "common/geometry/picture_place.h"
#include "common/image/jpeg.h"
#include "drivers/output/headless/headless_output.h"

namespace cyclorama::display {

/// A round room with a radius of 3 m and a striped wall, and a pole 0.2 m thick beside the visitor. The eye is at
/// height 0.
struct World {
  bool has_pole = true;

  struct Hit {
    double distance = 0.0;
    std::array<double, 3> code{};
  };
  [[nodiscard]] Hit seen(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray) const {
    const Eigen::Vector2d o(eye.x(), eye.z());
    const Eigen::Vector2d d(ray.x(), ray.z());
    const auto far_root = [&](const Eigen::Vector2d& centre, double radius, bool nearer) {
      const Eigen::Vector2d from = o - centre;
      const double a = d.squaredNorm();
      const double b = from.dot(d);
      const double root = b * b - a * (from.squaredNorm() - radius * radius);
      if (root < 0.0) return -1.0;
      return (-b + (nearer ? -1.0 : 1.0) * std::sqrt(root)) / a;
    };
    Hit hit{far_root({0, 0}, 3.0, false), {}};
    const Eigen::Vector3d wall = eye + hit.distance * ray;
    const double azimuth = std::atan2(wall.x(), -wall.z());
    hit.code = {127.5 + 100.0 * std::sin(24.0 * azimuth), 127.5 + 100.0 * std::sin(9.0 * wall.y()), 60.0};
    if (!has_pole) return hit;
    const double pole = far_root({0.4, -1.2}, 0.1, true);
    if (pole > 0.0 && pole < hit.distance) hit = {pole, {230.0, 220.0, 40.0}};
    return hit;
  }
};

/// Renders a frame of the world. Each pixel has a random error of up to ±`noise_codes`, which depends on `seed`.
inline DisplayFrame frame_of(const World& world, const Projection& picture, const Eigen::Vector3d& eye,
                             double heading_rad = 0.0, double noise_codes = 0.0, unsigned seed = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-noise_codes, noise_codes);
  const Eigen::AngleAxisd R_world_eye(-heading_rad, Eigen::Vector3d::UnitY());
  RgbImage pixels(picture.width_px(), picture.height_px());
  const PixelRect cells = depth_cells({0, 0, pixels.width(), pixels.height()});
  InverseDepthImage depth(cells.width, cells.height);
  for (int y = 0; y < pixels.height(); ++y) {
    for (int x = 0; x < pixels.width(); ++x) {
      const auto ray = picture.ray_at({x + 0.5, y + 0.5});
      if (!ray) continue;
      const World::Hit hit = world.seen(eye + R_world_eye * ray->origin, R_world_eye * ray->direction);
      const double error = noise(random);
      for (int c = 0; c < 3; ++c) {
        const double code = hit.code[static_cast<std::size_t>(c)] + error;
        pixels.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0, 255.0)));
      }
      std::uint16_t* const cell = depth.at(x / kDepthCellPx, y / kDepthCellPx);
      *cell = std::max(*cell, inverse_depth_of(static_cast<float>(hit.distance)));
    }
  }
  DisplayFrame frame;
  frame.eye_m = eye;
  frame.heading_rad = heading_rad;
  frame.shape = picture.shape;
  frame.stacked = picture.stacked();
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(pixels));
  frame.mesh =
      std::make_shared<const ReprojectionMesh>(std::make_shared<const ReprojectionGrid>(picture, kDepthCellPx), depth);
  return frame;
}

/// Draws the middle of a picture, pixel by pixel, as a head sees it. Only one may exist at a time, because each has a
/// GL context.
class Drawing {
 public:
  explicit Drawing(const Projection& picture, Texels texels = Texels::kHalves, MeshFilter filter = MeshFilter::kSharp)
      : width_(picture.width_px() / 2), height_(height_px(picture.shape) / 2) {
    auto opened = output::open_headless_output({{{"head", width_, height_}}, 100.0, {}, {}}, clock_);
    CHECK(opened.has_value());
    output_ = *std::move(opened);
    const PixelScale scale = pixel_scale(picture.shape);
    warp::PixelMap map(width_, height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const PicturePlace place = scale.place_at({x + 0.5 + 0.5 * width_, y + 0.5 + 0.5 * height_});
        map.at(x, y)[0] = static_cast<float>(place.across);
        map.at(x, y)[1] = static_cast<float>(place.up);
      }
    }
    HeadPlan plan;
    plan.picture = picture.shape;
    plan.warp = map;
    plan.mask = warp::MaskImage(width_, height_, 1.0f);
    const output::Gl& gl = output_->gl();
    auto program = PictureProgram::make(gl, texels);
    CHECK(program.has_value());
    program_.emplace(*std::move(program));
    programs_.emplace(gl);
    auto painter = HeadPainter::make(gl, &*programs_, plan, texels);
    CHECK(painter.has_value());
    painter_.emplace(*std::move(painter));
    auto light = FrameLight::make(gl, *program_, texels, filter);
    CHECK(light.has_value());
    light_.emplace(*std::move(light));
  }

  /// Draws a frame without earlier ones, moved by `eye` (Eye frame of the picture) and turned.
  RgbImage of(const DisplayFrame& frame, const Eigen::Vector3d& eye = Eigen::Vector3d::Zero(), double turn_rad = 0.0) {
    light_->forget();
    return after_earlier(frame, eye, turn_rad);
  }
  /// Draws a frame like of(), but after the earlier ones.
  RgbImage after_earlier(const DisplayFrame& frame, const Eigen::Vector3d& eye = Eigen::Vector3d::Zero(),
                         double turn_rad = 0.0) {
    CHECK(light_->take(frame));
    CHECK(light_->move(frame, eye));
    return drawn(turn_rad);
  }
  /// Takes a frame that refines the one before.
  void begin_fade(const DisplayFrame& frame) {
    CHECK(light_->take(frame));
    CHECK(light_->is_fading());
  }
  /// Draws `share` of the refining frame and the rest of the one before.
  RgbImage faded(double share) {
    CHECK(light_->fade(share));
    return drawn(0.0);
  }
  [[nodiscard]] bool is_fading() const { return light_->is_fading(); }
  /// Draws the frame that was moved before, from its original eye.
  RgbImage unmoved(const DisplayFrame& frame) {
    CHECK(light_->move(frame, Eigen::Vector3d::Zero()));
    return drawn(0.0);
  }
  [[nodiscard]] std::size_t torn() const { return light_->reprojection().torn(); }

 private:
  RgbImage drawn(double turn_rad) {
    CHECK(output_->draw_to(0));
    painter_->draw({&light_->panorama(), turn_rad});
    RgbaImage read_back(width_, height_);
    output_->gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
    output_->gl().ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, read_back.data().data());
    CHECK(output_->gl().check("drawing"));
    RgbImage result(width_, height_);
    output::to_picture(read_back, &result);
    return result;
  }

  int width_;
  int height_;
  SteadyClock clock_;
  std::unique_ptr<output::Output> output_;
  std::optional<PictureProgram> program_;
  std::optional<HeadPrograms> programs_;
  std::optional<HeadPainter> painter_;
  std::optional<FrameLight> light_;
};

inline double psnr(const RgbImage& a, const RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    const double difference = static_cast<double>(a.data()[i]) - b.data()[i];
    sum += difference * difference;
  }
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(a.data().size()) / std::max(sum, 1e-9));
}

}  // namespace cyclorama::display
