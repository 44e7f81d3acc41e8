// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/simulated/tag_painter.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "common/base/check.h"

namespace cyclorama {
namespace {

constexpr float kNothing = -1.0f;
/// Printed paper: black ink still reflects a little.
constexpr float kInkGrey = 18.0f;
constexpr float kPaperGrey = 225.0f;
constexpr float kSkinGrey = 150.0f;
constexpr float kSleeveGrey = 60.0f;
/// The scene around the tag, in tag sizes: card, thumb on its lower edge, arm below.
constexpr double kCardHalf = 0.78;
constexpr double kSceneHalfWidth = 0.80;
constexpr double kSceneTop = -0.80;
constexpr double kSceneBottom = 2.6;
bool in_ellipse(double x, double y, double centre_x, double centre_y, double radius_x, double radius_y) {
  const double dx = (x - centre_x) / radius_x;
  const double dy = (y - centre_y) / radius_y;
  return dx * dx + dy * dy <= 1.0;
}

struct Box {
  int left, top, right, bottom;  ///< Half-open.
};

struct Sample {
  double du, dv;       ///< Place within the pixel.
  std::size_t moment;  ///< Of the exposure.
};

/// A Hammersley net over the pixel: S points have S different columns and S different rows, so that an edge in any
/// direction is placed to a 2S-th of a pixel. The points of one moment fall into all its columns and rows alike: with i
/// written as high and low half, the column's leading digits are the high half and the row's the reversed low half, and
/// a moment holds the pairs whose halves differ by a fixed exclusive or.
std::vector<Sample> samples_of(std::size_t moments) {
  unsigned bits = 2;
  while ((std::size_t{1} << bits) < moments) ++bits;
  const std::size_t half = std::size_t{1} << bits;
  const std::size_t count = half * half;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t reversed = 0;
    for (unsigned bit = 0; bit < 2 * bits; ++bit) reversed |= ((i >> bit) & 1U) << (2 * bits - 1 - bit);
    const double width = 1.0 / static_cast<double>(count);
    samples.push_back({(static_cast<double>(i) + 0.5) * width, (static_cast<double>(reversed) + 0.5) * width,
                       ((i / half) ^ (i % half)) % moments});
  }
  return samples;
}

/// The pixels that the painted scene can touch, for a map from its plane (in tag sizes) to the picture.
Box box_of(const Eigen::Matrix3d& to_image, const Pinhole& lens) {
  const Box all{0, 0, lens.width_px, lens.height_px};
  Eigen::AlignedBox2d around;
  for (const double y : {kSceneTop, kSceneBottom}) {
    for (const double x : {-kSceneHalfWidth, kSceneHalfWidth}) {
      const Eigen::Vector3d corner = to_image * Eigen::Vector3d(x, y, 1.0);
      if (!(corner.z() > 1e-6)) return all;
      around.extend(Eigen::Vector2d(corner.x() / corner.z(), corner.y() / corner.z()));
    }
  }
  const auto clamped = [](double value, int most) { return static_cast<int>(std::clamp(value, 0.0, 1.0 * most)); };
  return {clamped(std::floor(around.min().x()), lens.width_px), clamped(std::floor(around.min().y()), lens.height_px),
          clamped(std::ceil(around.max().x()), lens.width_px), clamped(std::ceil(around.max().y()), lens.height_px)};
}

/// Plane (x, y, 1) in tag sizes to homogeneous pixels.
Eigen::Matrix3d plane_to_image(const RigidTransform<frame::Camera, frame::Tag>& pose, double size_m,
                               const Pinhole& lens) {
  const Eigen::Matrix3d rotation = pose.rotation().toRotationMatrix();
  Eigen::Matrix3d plane;
  plane << size_m * rotation.col(0), size_m * rotation.col(1), pose.translation();
  Eigen::Matrix3d k;
  k << lens.focal_px, 0.0, lens.centre_u_px, 0.0, lens.focal_px, lens.centre_v_px, 0.0, 0.0, 1.0;
  return k * plane;
}

}  // namespace

TagPainter::TagPainter(int id, double size_m) : size_m_(size_m) {
  apriltag_family_t* const family = tag36h11_create();
  CHECK(size_m > 0.0 && id >= 0 && id < static_cast<int>(family->ncodes));
  // 16 bits: Debian 12's library takes an int here, Debian 13's an unsigned.
  image_u8_t* const image = apriltag_to_image(family, static_cast<std::uint16_t>(id));
  cells_ = image->width;
  bitmap_width_ = static_cast<double>(family->total_width) / family->width_at_border;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x)
      bitmap_.push_back(image->buf[y * image->stride + x] > 127 ? kPaperGrey : kInkGrey);
  }
  // What image_u8_destroy() does; Debian's library keeps that one to itself.
  std::free(image->buf);
  std::free(image);
  tag36h11_destroy(family);
}

float TagPainter::grey_at(double x, double y) const {
  // The thumb stays off the white border, which a detector needs.
  if (y > bitmap_width_ / 2.0 && in_ellipse(x, y, 0.32, 0.80, 0.10, 0.16)) return kSkinGrey;
  if (std::abs(x) <= kCardHalf && std::abs(y) <= kCardHalf) {
    const int cell_x = static_cast<int>(std::floor((x / bitmap_width_ + 0.5) * cells_));
    const int cell_y = static_cast<int>(std::floor((y / bitmap_width_ + 0.5) * cells_));
    if (cell_x < 0 || cell_y < 0 || cell_x >= cells_ || cell_y >= cells_) return kPaperGrey;
    return bitmap_[static_cast<std::size_t>(cell_y * cells_ + cell_x)];
  }
  if (in_ellipse(x, y, 0.25, 0.98, 0.28, 0.30)) return kSkinGrey;
  if (y > 1.1 && y < kSceneBottom && std::abs(x - 0.25) < 0.20 + 0.05 * (y - 1.1)) return kSleeveGrey;
  return kNothing;
}

void TagPainter::paint(const std::vector<RigidTransform<frame::Camera, frame::Tag>>& poses, const Pinhole& lens,
                       Image<float, 1>* picture) const {
  CHECK(!poses.empty() && picture->width() == lens.width_px && picture->height() == lens.height_px);
  std::vector<Eigen::Matrix3d> to_plane;
  Box box{lens.width_px, lens.height_px, 0, 0};
  for (const auto& pose : poses) {
    const Eigen::Matrix3d to_image = plane_to_image(pose, size_m_, lens);
    // Edge on, the card has no area: no ray meets it, which a zero matrix says.
    const bool has_area = std::abs(to_image.determinant()) > 1e-12;
    to_plane.push_back(has_area ? Eigen::Matrix3d(to_image.inverse()) : Eigen::Matrix3d(Eigen::Matrix3d::Zero()));
    const Box one = box_of(to_image, lens);
    box = {std::min(box.left, one.left), std::min(box.top, one.top), std::max(box.right, one.right),
           std::max(box.bottom, one.bottom)};
  }
  const std::vector<Sample> samples = samples_of(poses.size());
  for (int v = box.top; v < box.bottom; ++v) {
    for (int u = box.left; u < box.right; ++u) {
      float* const grey = picture->at(u, v);
      float sum = 0.0f;
      for (const Sample& sample : samples) {
        const Eigen::Vector3d plane = to_plane[sample.moment] * Eigen::Vector3d(u + sample.du, v + sample.dv, 1.0);
        // z is 1 / depth: a ray that meets the plane behind the lens sees nothing of it.
        const float seen = plane.z() > 0.0 ? grey_at(plane.x() / plane.z(), plane.y() / plane.z()) : kNothing;
        sum += seen < 0.0f ? *grey : seen;
      }
      *grey = sum / static_cast<float>(samples.size());
    }
  }
}

}  // namespace cyclorama
