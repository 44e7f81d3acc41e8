// SPDX-License-Identifier: Apache-2.0
/// Draws one head with GL, reads it back, and compares it with the CPU reference.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <random>

#include "common/image/jpeg.h"
#include "drivers/output/headless/headless_output.h"
#include "tests/support/exact_picture.h"

namespace cyclorama {

/// Opens a new output for each picture, so that no state remains from the previous picture.
class PaintedHead {
 public:
  /// Without `texels`, uses the kind that a display would choose.
  explicit PaintedHead(output::HeadlessOptions::Renderer renderer, std::optional<display::Texels> texels = std::nullopt)
      : renderer_(renderer), texels_(texels) {}

  /// Draws a head. Rows are from the top.
  RgbImage drawn(const display::HeadPlan& plan, const PlanarPicture& picture, const PictureShape& shape, double shift,
                 const std::vector<PixelRect>* parts = nullptr) {
    return drawn(plan, [&](const output::Gl& gl, const display::PictureProgram& program,
                           const display::HeadPainter& painter, output::Output* output) {
      display::PanoramaTexture texture(gl, program);
      CHECK(texture.upload(frame(picture, shape, parts)));
      CHECK(output->draw_to(0));
      painter.draw({&texture, shift});
    });
  }
  /// Draws a picture after another one was drawn in its place.
  RgbImage drawn_after(const display::HeadPlan& plan, const PlanarPicture& before, const PictureShape& shape_before,
                       const PlanarPicture& picture, const PictureShape& shape) {
    return drawn(plan, [&](const output::Gl& gl, const display::PictureProgram& program,
                           const display::HeadPainter& painter, output::Output* output) {
      display::PanoramaTexture texture(gl, program);
      CHECK(texture.upload(frame(before, shape_before, nullptr)));
      CHECK(texture.upload(frame(picture, shape, nullptr)));
      CHECK(output->draw_to(0));
      painter.draw({&texture, 0.0});
    });
  }
  RgbImage faded(const display::HeadPlan& plan, const PlanarPicture& a, const PlanarPicture& b,
                 const PictureShape& shape, double share) {
    return drawn(plan, [&](const output::Gl& gl, const display::PictureProgram& program,
                           const display::HeadPainter& painter, output::Output* output) {
      display::PanoramaTexture first(gl, program);
      display::PanoramaTexture second(gl, program);
      CHECK(first.upload(frame(a, shape, nullptr)) && second.upload(frame(b, shape, nullptr)));
      CHECK(output->draw_to(0));
      painter.draw({&first, 0.0}, {&second, 0.0}, share);
    });
  }

  /// Draws the whole head from the stacked pictures of both eyes, each of `shape`, or from one picture for both eyes.
  RgbImage drawn_for_two(const display::HeadPlan& plan, const PlanarPicture& picture, const PictureShape& shape,
                         double shift, Eye now = Eye::kLeft) {
    return drawn(plan, [&](const output::Gl& gl, const display::PictureProgram& program,
                           const display::HeadPainter& painter, output::Output* output) {
      display::PanoramaTexture texture(gl, program);
      display::DisplayFrame both = frame(picture, shape, nullptr);
      both.stacked = picture.height() / height_px(shape);
      CHECK(texture.upload(both));
      CHECK(output->draw_to(0));
      painter.draw({&texture, shift}, now);
    });
  }

  static display::DisplayFrame frame(const PlanarPicture& picture, const PictureShape& shape,
                                     const std::vector<PixelRect>* parts) {
    display::DisplayFrame frame;
    frame.shape = shape;
    frame.picture = std::make_shared<const PlanarPicture>(picture);
    if (parts != nullptr) frame.parts = std::make_shared<const std::vector<PixelRect>>(*parts);
    return frame;
  }

 private:
  template <typename Draw>
  RgbImage drawn(const display::HeadPlan& plan, const Draw& draw) {
    const int width = width_px(plan.warp) * (plan.packing == StereoPacking::kSideBySide ? 2 : 1);
    const int height = height_px(plan.warp) * (plan.packing == StereoPacking::kTopBottom ? 2 : 1);
    auto output = output::open_headless_output({{{"head", width, height}}, 100.0, {}, renderer_}, clock_);
    CHECK(output.has_value());
    const output::Gl& gl = (*output)->gl();
    const display::Texels texels = texels_.value_or(display::texels_for(gl, {plan}));
    auto program = display::PictureProgram::make(gl, texels);
    CHECK(program.has_value());
    display::HeadPrograms programs(gl);
    auto painter = display::HeadPainter::make(gl, &programs, plan, texels);
    CHECK(painter.has_value());
    draw(gl, *program, *painter, output->get());
    RgbaImage read_back(width, height);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, read_back.data().data());
    CHECK(gl.check("drawing"));
    RgbImage result(width, height);
    output::to_picture(read_back, &result);
    return result;
  }
  output::HeadlessOptions::Renderer renderer_;
  std::optional<display::Texels> texels_;
  SteadyClock clock_;
};

/// Returns true if a pixel centre is on the edge of a triangle that is not drawn. Such a pixel may be drawn or not,
/// because GPUs snap corners to 1/256 px.
inline bool is_on_the_rim(const warp::Warp& warp, int x, int y) {
  const warp::WarpMesh* const mesh = std::get_if<warp::WarpMesh>(&warp);
  if (mesh == nullptr) return false;
  constexpr double kSnap_px = 1.0 / 64.0;
  int drawn = 0;
  for (int off = 0; off < 4; ++off) {
    const Eigen::Vector2d near(x + 0.5 + (off % 2 == 0 ? -kSnap_px : kSnap_px),
                               y + 0.5 + (off < 2 ? -kSnap_px : kSnap_px));
    drawn += mesh->interpolate(near) ? 1 : 0;
  }
  return drawn != 0 && drawn != 4;
}

/// Returns the maximum difference, in 8-bit codes, between a drawn picture and the range of the reference. The range is
/// over positions within `slack_px`, and over a relative error of `slack_light` in each light.
inline double worst_difference(const RgbImage& drawn, const display::HeadPlan& plan, const ExactPicture& reference,
                               double slack_px, double slack_light = 0.0) {
  double worst = 0.0;
  for (int y = 0; y < drawn.height(); ++y) {
    for (int x = 0; x < drawn.width(); ++x) {
      if (is_on_the_rim(plan.warp, x, y)) continue;
      Eigen::Vector3d min = reference.code_at(plan, x, y);
      Eigen::Vector3d max = min;
      // Between the ends of the slack, the light is monotonic, except at a pixel centre of the picture.
      const Eigen::Vector2d centre = reference.to_centre(plan.warp, x, y).cwiseMax(-slack_px).cwiseMin(slack_px);
      const std::array<Eigen::Vector2d, 4> correspondences{Eigen::Vector2d(0.0, 0.0), centre,
                                                           Eigen::Vector2d(slack_px, slack_px),
                                                           Eigen::Vector2d(-slack_px, -slack_px)};
      for (unsigned off = 0; (slack_px > 0.0 || slack_light > 0.0) && off < 48; ++off) {
        const Eigen::Vector3d moved =
            reference.code_at(plan, x, y, correspondences[off % 4].x(), correspondences[off / 4 % 4].y(),
                              (static_cast<int>(off / 16) - 1) * slack_light);
        min = min.cwiseMin(moved);
        max = max.cwiseMax(moved);
      }
      // A pixel beside the wall stays black.
      const bool is_black = reference.is_black(plan, x, y);
      const auto [darker, brighter] = is_black ? std::pair(0.0, 0.0) : ExactPicture::dither_at(plan, x, y);
      for (int c = 0; c < 3; ++c) {
        const double value = drawn.at(x, y)[c];
        const double lowest = std::clamp(min[c] + darker, 0.0, 1.0);
        const double highest = std::clamp(max[c] + brighter, 0.0, 1.0);
        worst = std::max({worst, 255.0 * lowest - value, value - 255.0 * highest});
      }
    }
  }
  return worst;
}

/// Random plans and pictures; all their parameters vary.
class RandomHeads {
 public:
  explicit RandomHeads(unsigned seed) : random_(seed) {}
  std::mt19937& random() { return random_; }
  double between(double a, double b) { return std::uniform_real_distribution(a, b)(random_); }
  int pixels(int min, int max) { return std::uniform_int_distribution(min, max)(random_); }
  bool one_in(unsigned n) { return random_() % n == 0; }

  PlanarPicture noise(int width, int height, bool half) {
    PlanarPicture picture(width, height, half);
    for (std::uint8_t& value : picture.luma().data()) value = static_cast<std::uint8_t>(random_());
    for (GreyImage* plane : {&picture.blue(), &picture.red()}) {
      for (std::uint8_t& value : plane->data()) value = static_cast<std::uint8_t>(random_());
    }
    return picture;
  }
  /// Returns a mesh whose cells have positions inside and slightly outside a panorama; some have no position. Cells are
  /// large and arbitrary. With `has_tiny_cells`, each is one pixel, and neighbours are a few pixels of the panorama
  /// apart: GPUs interpolate in floats and round corners to 1/256 px, so steeper cells would be off by more than 0.02
  /// px.
  warp::WarpMesh mesh(int width, int height, double span_rad, bool has_tiny_cells = false) {
    const auto cells = [&](int size) { return has_tiny_cells ? size : pixels(1, std::clamp(size / 12, 1, 9)); };
    warp::WarpMesh mesh{width, height, cells(width), cells(height), {}, 0.0};
    for (int j = 0; j <= mesh.cells_y; ++j) {
      for (int i = 0; i <= mesh.cells_x; ++i) {
        warp::WarpVertex vertex{static_cast<float>(width) * static_cast<float>(i) / static_cast<float>(mesh.cells_x),
                                static_cast<float>(height) * static_cast<float>(j) / static_cast<float>(mesh.cells_y),
                                static_cast<float>(between(-0.6, 0.6) * span_rad),
                                static_cast<float>(between(-0.6, 0.6))};
        if (has_tiny_cells) {
          vertex.azimuth_rad = static_cast<float>(span_rad * (i / 150.0 - 0.6 + between(0.0, 0.005)));
          vertex.tan_elevation = static_cast<float>(0.6 - j / 150.0 + between(0.0, 0.005));
        }
        if (one_in(20)) vertex.azimuth_rad = std::numeric_limits<float>::quiet_NaN();
        mesh.vertices.push_back(vertex);
      }
    }
    return mesh;
  }
  warp::PixelMap map(int width, int height, double span_rad) {
    warp::PixelMap map(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        map.at(x, y)[0] = static_cast<float>(between(-0.6, 0.6) * span_rad);
        map.at(x, y)[1] = one_in(20) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(between(-0.6, 0.6));
      }
    }
    return map;
  }
  /// Returns the shape of a flat wall or a dome, with positions around its axis that a wall may have.
  PictureShape other_shape(int width, int height) {
    const double tilt = between(-1.5, 1.5);
    if (one_in(2)) return Fisheye{width, height, between(1.0, 6.0), tilt};
    return Perspective{width, height, between(-1.2, -0.3), between(0.3, 1.2), between(0.3, 1.2), between(-1.2, -0.3),
                       tilt};
  }
  /// Returns noise with many zeros and ones, and one large area of ones.
  warp::MaskImage mask(int width, int height) {
    warp::MaskImage mask(width, height, 1.0f);
    const int left = pixels(0, width);
    for (int y = 0; y < height; ++y) {
      for (int x = left; x < width; ++x) *mask.at(x, y) = static_cast<float>(std::clamp(between(-0.2, 1.2), 0.0, 1.0));
    }
    return mask;
  }
  /// Returns a random monotonic curve with slopes of up to eight.
  warp::ResponseCurve curve() {
    std::vector<double> sums{0.0};
    for (int i = 0; i < 32; ++i) sums.push_back(sums.back() + (one_in(3) ? 0.0 : between(0.0, 8.0)));
    warp::ResponseCurve curve;
    const double first = between(0.0, 0.2);
    for (const double sum : sums) {
      curve.codes.push_back(
          static_cast<float>(std::min(1.0, first + (1.0 - first) * sum / std::max(32.0, sums.back()))));
    }
    return curve;
  }
  warp::HeadColour colour(int width, int height) {
    warp::HeadColour colour;
    if (one_in(2)) {
      colour.matrix = Eigen::Matrix3d::Identity();
      for (int i = 0; i < 9; ++i) (*colour.matrix)(i / 3, i % 3) += between(-0.2, 0.2);
    }
    if (one_in(2)) {
      colour.black = {between(0.0, 0.1), between(0.0, 0.1), between(0.0, 0.1)};
      colour.black_lift = warp::BlackLiftImage(width, height);
      for (float& black_lift : colour.black_lift->data()) black_lift = static_cast<float>(between(0.0, 1.0));
    }
    if (one_in(2)) colour.response = std::array{curve(), curve(), curve()};
    return colour;
  }

 private:
  std::mt19937 random_;
};

}  // namespace cyclorama
