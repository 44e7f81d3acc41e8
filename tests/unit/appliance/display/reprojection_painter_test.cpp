// SPDX-License-Identifier: Apache-2.0
// Draws moved pictures with GL, and compares them with pictures of the same world from the moved eye.
#include "appliance/display/reprojection_painter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "appliance/display/head_painter.h"
#include "common/geometry/picture_place.h"
#include "common/image/jpeg.h"
#include "drivers/output/headless/headless_output.h"

namespace cyclorama::display {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// A round room of 3 m with a striped wall, and a pole of 0.2 m beside the visitor; the eye's height is 0.
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

DisplayFrame frame_of(const World& world, const Projection& picture, const Eigen::Vector3d& eye) {
  RgbImage pixels(picture.width_px(), picture.height_px());
  const PixelRect cells = depth_cells({0, 0, pixels.width(), pixels.height()});
  InverseDepthImage depth(cells.width, cells.height);
  for (int y = 0; y < pixels.height(); ++y) {
    for (int x = 0; x < pixels.width(); ++x) {
      const auto ray = picture.ray_at({x + 0.5, y + 0.5});
      if (!ray) continue;
      const World::Hit hit = world.seen(eye + ray->origin, ray->direction);
      for (int c = 0; c < 3; ++c) pixels.at(x, y)[c] = static_cast<std::uint8_t>(hit.code[static_cast<std::size_t>(c)]);
      std::uint16_t* const cell = depth.at(x / kDepthCellPx, y / kDepthCellPx);
      *cell = std::max(*cell, inverse_depth_of(static_cast<float>(hit.distance)));
    }
  }
  DisplayFrame frame;
  frame.shape = picture.shape;
  frame.stacked = picture.stacked();
  frame.picture = std::make_shared<const PlanarPicture>(JpegEncoder().to_planar(pixels));
  frame.mesh =
      std::make_shared<const ReprojectionMesh>(std::make_shared<const ReprojectionGrid>(picture, kDepthCellPx), depth);
  return frame;
}

/// Draws the middle of a picture, pixel by pixel, as a head sees it.
class Drawing {
 public:
  explicit Drawing(const Projection& picture, Texels texels = Texels::kHalves)
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
    auto reprojection = ReprojectionPainter::make(gl, texels);
    CHECK(reprojection.has_value());
    reprojection_.emplace(*std::move(reprojection));
    panorama_.emplace(gl, *program_);
  }

  RgbImage of(const DisplayFrame& frame, const Eigen::Vector3d& eye = Eigen::Vector3d::Zero(), double turn_rad = 0.0) {
    CHECK(panorama_->upload(frame));
    if (!eye.isZero(0.0)) CHECK(reprojection_->draw(*frame.mesh, eye, &*panorama_));
    return drawn(turn_rad);
  }
  /// Draws the frame that was moved before, from its own eye.
  RgbImage unmoved(const DisplayFrame& frame) {
    panorama_->show_unmoved(frame);
    return drawn(0.0);
  }
  [[nodiscard]] std::size_t torn() const { return reprojection_->torn(); }

 private:
  RgbImage drawn(double turn_rad) {
    CHECK(output_->draw_to(0));
    painter_->draw({&*panorama_, turn_rad});
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
  std::optional<ReprojectionPainter> reprojection_;
  std::optional<PanoramaTexture> panorama_;
};

double psnr(const RgbImage& a, const RgbImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    const double difference = static_cast<double>(a.data()[i]) - b.data()[i];
    sum += difference * difference;
  }
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(a.data().size()) / std::max(sum, 1e-9));
}

const Projection kPanorama{Panorama{768, 256, 2.6, 0.45, -0.45}, {}};
const Projection kFlat{Perspective{640, 320, -1.0, 1.0, 0.5, -0.5, 0.1}, {}};
const Projection kDome{Fisheye{480, 480, 2.6, 0.3}, {}};

TEST(ReprojectionPainterTest, shows_a_room_from_the_moved_eye) {
  const World room{false};
  const Eigen::Vector3d eye(0.2, 0.05, -0.15);
  for (const Projection& picture : {kPanorama, kFlat, kDome}) {
    Drawing drawing(picture);
    const DisplayFrame source = frame_of(room, picture, Eigen::Vector3d::Zero());
    const RgbImage truth = drawing.of(frame_of(room, picture, eye));
    const double held = psnr(drawing.of(source), truth);
    const double moved = psnr(drawing.of(source, eye), truth);
    EXPECT_GT(moved, 38.0) << picture.shape.index();
    EXPECT_GT(moved, held + 15.0) << picture.shape.index();
  }
}

TEST(ReprojectionPainterTest, moves_a_near_pole_over_the_wall_behind_it) {
  const World world;
  const Eigen::Vector3d eye(-0.12, 0.0, 0.0);
  Drawing drawing(kPanorama);
  const DisplayFrame source = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
  const RgbImage truth = drawing.of(frame_of(world, kPanorama, eye));
  const double held = psnr(drawing.of(source), truth);
  const double moved = psnr(drawing.of(source, eye), truth);
  EXPECT_GT(drawing.torn(), 0U);
  EXPECT_GT(moved, held + 6.0);
  EXPECT_GT(moved, 25.0);
}

TEST(ReprojectionPainterTest, is_bit_identical_at_rest_whatever_was_drawn_before) {
  const World world;
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    Drawing drawing(kPanorama, texels);
    const DisplayFrame frame = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
    const RgbImage before = drawing.of(frame);
    EXPECT_NE(drawing.of(frame, {0.1, 0.0, 0.0}), before);
    EXPECT_EQ(drawing.unmoved(frame), before);
  }
}

TEST(ReprojectionPainterTest, agrees_between_both_formats_of_light) {
  const World world;
  const Eigen::Vector3d eye(0.1, -0.1, 0.1);
  const DisplayFrame frame = frame_of(world, kPanorama, Eigen::Vector3d::Zero());
  const RgbImage packed = Drawing(kPanorama, Texels::kPacked).of(frame, eye);
  const RgbImage halves = Drawing(kPanorama).of(frame, eye);
  EXPECT_GT(psnr(packed, halves), 45.0);
}

TEST(ReprojectionPainterTest, has_no_seam_in_a_whole_turn) {
  const Projection round{Panorama{1024, 256, kTurn, 0.45, -0.45}, {}};
  const World room{false};
  const Eigen::Vector3d eye(0.25, 0.0, 0.2);
  const DisplayFrame source = frame_of(room, round, Eigen::Vector3d::Zero());
  Drawing drawing(round);
  // The head looks at the middle of the picture; half a turn brings the seam there.
  constexpr double kBack = std::numbers::pi;
  const RgbImage truth = drawing.of(frame_of(room, round, eye), Eigen::Vector3d::Zero(), kBack);
  EXPECT_GT(psnr(drawing.of(source, eye, kBack), truth), 38.0);
}

TEST(ReprojectionPainterTest, draws_frames_of_other_sizes_one_after_another) {
  const World room{false};
  const Eigen::Vector3d eye(0.1, 0.0, 0.1);
  const DisplayFrame large = frame_of(room, kPanorama, Eigen::Vector3d::Zero());
  const DisplayFrame small = frame_of(room, {Panorama{384, 128, 2.6, 0.45, -0.45}, {}}, Eigen::Vector3d::Zero());
  const RgbImage large_alone = Drawing(kPanorama).of(large, eye);  // One context at a time.
  const RgbImage small_alone = Drawing(kPanorama).of(small, eye);
  Drawing drawing(kPanorama);
  for (int n = 0; n < 2; ++n) {
    EXPECT_GT(psnr(drawing.of(small, eye), small_alone), 55.0) << n;
    EXPECT_GT(psnr(drawing.of(large, eye), large_alone), 55.0) << n;
  }
}

}  // namespace
}  // namespace cyclorama::display
