// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/tag_painter.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/wand/tag_bitmap.h"

namespace cyclorama::simulated {
namespace {

constexpr float kNothing = -1.0f;
/// Black ink on paper still reflects a little light.
constexpr float kInkGrey = 18.0f;
constexpr float kPaperGrey = 225.0f;
constexpr float kSkinGrey = 150.0f;
constexpr float kSleeveGrey = 60.0f;
/// Half the size of a panel in tag sizes: for a card in the hand, and for a folded card, whose panels are little larger
/// than the tags with their borders.
constexpr double kCardHalf = 0.78;
constexpr double kPanelHalf = 0.642;
/// The hand, in units of kHandUnitM, or of the tag's size where it holds a flat card.
constexpr double kHandUnitM = 0.12;
constexpr double kHandHalfWidth = 0.80;
constexpr double kHandBottom = 2.6;

bool in_ellipse(double x, double y, double centre_x, double centre_y, double radius_x, double radius_y) {
  const double dx = (x - centre_x) / radius_x;
  const double dy = (y - centre_y) / radius_y;
  return dx * dx + dy * dy <= 1.0;
}

struct Box {
  int left, top, right, bottom;  ///< Half-open ranges.
};

struct Sample {
  double du, dv;       ///< Offset within the pixel.
  std::size_t moment;  ///< Index of the moment within the exposure.
};

/// Hammersley points over the pixel: S points have S different columns and S different rows, so that an edge in any
/// direction is located to 1/(2S) of a pixel. Let h and l be the high and the low half of the bits of i: the leading
/// digits of the column are h, those of the row are l reversed, and the moment is (h xor l) modulo `moments`. The
/// points of each moment are therefore spread evenly over columns and rows.
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

/// Returns bounds of the pixels that a box of a plane can touch. `to_image` maps the plane to the picture.
Box box_of(const Eigen::Matrix3d& to_image, const Eigen::AlignedBox2d& scene, const Pinhole& lens) {
  const Box all{0, 0, lens.width_px, lens.height_px};
  Eigen::AlignedBox2d around;
  for (const double y : {scene.min().y(), scene.max().y()}) {
    for (const double x : {scene.min().x(), scene.max().x()}) {
      const Eigen::Vector3d corner = to_image * Eigen::Vector3d(x, y, 1.0);
      if (!(corner.z() > 1e-6)) return all;
      around.extend(Eigen::Vector2d(corner.x() / corner.z(), corner.y() / corner.z()));
    }
  }
  const auto clamped = [](double value, int max) { return static_cast<int>(std::clamp(value, 0.0, 1.0 * max)); };
  return {clamped(std::floor(around.min().x()), lens.width_px), clamped(std::floor(around.min().y()), lens.height_px),
          clamped(std::ceil(around.max().x()), lens.width_px), clamped(std::ceil(around.max().y()), lens.height_px)};
}

/// Returns the homography from plane coordinates (x, y, 1) in units to homogeneous pixels.
Eigen::Matrix3d plane_to_image(const RigidTransform<frame::Camera, frame::Face>& pose, double unit_m,
                               const Pinhole& lens) {
  const Eigen::Matrix3d rotation = pose.rotation().toRotationMatrix();
  Eigen::Matrix3d plane;
  plane << unit_m * rotation.col(0), unit_m * rotation.col(1), pose.translation();
  Eigen::Matrix3d k;
  k << lens.focal_px, 0.0, lens.centre_u_px, 0.0, lens.focal_px, lens.centre_v_px, 0.0, 0.0, 1.0;
  return k * plane;
}

/// One panel at one moment.
struct SeenPanel {
  Eigen::Matrix3d to_plane;
  bool from_behind;
  Eigen::Vector3d at_pixel;  ///< Image of the current pixel's corner.
};

}  // namespace

TagPainter::TagPainter(const Wand& wand) {
  CHECK(!wand.tags.empty());
  const bool alone = wand.tags.size() == 1;
  double bottom = -1e9;
  for (const WandTag& tag : wand.tags) {
    CHECK(tag.size_m > 0.0);
    const TagBitmap bitmap = tag_bitmap(tag.id);
    Panel panel{face_of(tag), tag.size_m, alone ? kCardHalf : kPanelHalf, {}, bitmap.cells, bitmap.width_in_tags,
                {},           alone};
    panel.box.extend(Eigen::Vector2d(-panel.half, -panel.half));
    panel.box.extend(Eigen::Vector2d(panel.half, alone ? 1.0 : panel.half));
    for (const bool white : bitmap.white) panel.bitmap.push_back(white ? kPaperGrey : kInkGrey);
    panels_.push_back(std::move(panel));
    for (const Eigen::Vector3d& corner : tag.corners) bottom = std::max(bottom, corner.y());
  }
  // The hand has its natural size, except for a card that is held with two fingers.
  const double unit_m = alone ? wand.tags[0].size_m : kHandUnitM;
  Panel hand{{Eigen::Quaterniond::Identity(), {0.0, alone ? 0.0 : bottom + 0.01 - kCardHalf * unit_m, 0.0}},
             unit_m,
             0.0,
             {},
             0,
             0.0,
             {},
             false};
  hand.box.extend(Eigen::Vector2d(-kHandHalfWidth, 0.6));
  hand.box.extend(Eigen::Vector2d(kHandHalfWidth, kHandBottom));
  panels_.push_back(std::move(hand));
}

float TagPainter::Panel::grey_at(double x, double y) const {
  if (cells == 0) {
    if (in_ellipse(x, y, 0.25, 0.98, 0.28, 0.30)) return kSkinGrey;
    if (y > 1.1 && y < kHandBottom && std::abs(x - 0.25) < 0.20 + 0.05 * (y - 1.1)) return kSleeveGrey;
    return kNothing;
  }
  // The thumb does not cover the white border, which a detector needs.
  if (has_thumb && y > bitmap_width / 2.0 && in_ellipse(x, y, 0.32, 0.80, 0.10, 0.16)) return kSkinGrey;
  if (!(std::abs(x) <= half && std::abs(y) <= half)) return kNothing;
  // Avoids floor(), which is a function call on older processors; the paper ends before cell -2.
  const int cell_x = static_cast<int>((x / bitmap_width + 0.5) * cells + 2.0) - 2;
  const int cell_y = static_cast<int>((y / bitmap_width + 0.5) * cells + 2.0) - 2;
  if (cell_x < 0 || cell_y < 0 || cell_x >= cells || cell_y >= cells) return kPaperGrey;
  return bitmap[static_cast<std::size_t>(cell_y * cells + cell_x)];
}

void TagPainter::paint(const std::vector<RigidTransform<frame::Camera, frame::Tag>>& poses, const Pinhole& lens,
                       Image<float, 1>* picture) const {
  CHECK(!poses.empty() && picture->width() == lens.width_px && picture->height() == lens.height_px);
  std::vector<SeenPanel> seen;  // Ordered by moment, then panel.
  std::vector<Box> boxes(panels_.size(), Box{lens.width_px, lens.height_px, 0, 0});
  Box box{lens.width_px, lens.height_px, 0, 0};
  const auto join = [](const Box& a, const Box& b) {
    return Box{std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
               std::max(a.bottom, b.bottom)};
  };
  for (const auto& pose : poses) {
    for (std::size_t i = 0; i < panels_.size(); ++i) {
      const auto T_camera_face = pose * panels_[i].T_tag_face;
      const Eigen::Matrix3d to_image = plane_to_image(T_camera_face, panels_[i].unit_m, lens);
      // An edge-on panel has no area, so no ray meets it; a zero matrix represents that.
      const bool has_area = std::abs(to_image.determinant()) > 1e-12;
      const Eigen::Vector3d into = T_camera_face.rotation() * Eigen::Vector3d::UnitZ();
      seen.push_back({has_area ? Eigen::Matrix3d(to_image.inverse()) : Eigen::Matrix3d(Eigen::Matrix3d::Zero()),
                      into.dot(T_camera_face.translation()) < 0.0, Eigen::Vector3d::Zero()});
      boxes[i] = join(boxes[i], box_of(to_image, panels_[i].box, lens));
    }
  }
  for (const Box& one : boxes) box = join(box, one);
  const std::vector<Sample> samples = samples_of(poses.size());
  std::vector<std::size_t> here;
  for (int v = box.top; v < box.bottom; ++v) {
    for (int u = box.left; u < box.right; ++u) {
      here.clear();
      for (std::size_t i = 0; i < panels_.size(); ++i) {
        if (u >= boxes[i].left && u < boxes[i].right && v >= boxes[i].top && v < boxes[i].bottom) here.push_back(i);
      }
      if (here.empty()) continue;
      for (std::size_t moment = 0; moment < poses.size(); ++moment) {
        for (const std::size_t i : here) {
          SeenPanel& panel = seen[moment * panels_.size() + i];
          panel.at_pixel = panel.to_plane * Eigen::Vector3d(u, v, 1.0);
        }
      }
      float* const grey = picture->at(u, v);
      float sum = 0.0f;
      for (const Sample& sample : samples) {
        float nearest = *grey;
        double inverse_depth = 0.0;
        for (const std::size_t i : here) {
          const SeenPanel& panel = seen[sample.moment * panels_.size() + i];
          const Eigen::Matrix3d& m = panel.to_plane;
          // z is 1 / depth: a ray that meets the plane behind the lens does not see it.
          const double z = panel.at_pixel.z() + m(2, 0) * sample.du + m(2, 1) * sample.dv;
          if (!(z > inverse_depth)) continue;
          const float there = panels_[i].grey_at((panel.at_pixel.x() + m(0, 0) * sample.du + m(0, 1) * sample.dv) / z,
                                                 (panel.at_pixel.y() + m(1, 0) * sample.du + m(1, 1) * sample.dv) / z);
          if (there < 0.0f) continue;
          nearest = panel.from_behind && panels_[i].cells > 0 ? kPaperGrey : there;
          inverse_depth = z;
        }
        sum += nearest;
      }
      *grey = sum / static_cast<float>(samples.size());
    }
  }
}

}  // namespace cyclorama::simulated
