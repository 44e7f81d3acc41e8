// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::tags {

/// Settings of the detector. docs/trade.md plots decimation against tags found and milliseconds.
struct DetectorSettings {
  std::string family = "tag36h11";  ///< One of tag_families().
  /// Factor by which the picture in which quads are sought is reduced: 1 to 8. Effectively 1, 1.5 or a whole number:
  /// the next lower one.
  double decimate = 1.5;
  bool tiles = true;  ///< Also searches full resolution around known tags, and tile by tile: tag_search.h.
  int threads = 1;                  ///< 1 to 16.
  bool refine_edges = true;         ///< Aligns edges to the gradients of the full picture; useful with any decimation.
  bool refine_corners = true;       ///< Then refines corners to a few hundredths of a pixel: corner_refinement.h.
  int max_hamming = 0;  ///< Number of wrong bits that are corrected: 0, 1 or 2. Each lets more clutter pass as tags.
  double min_margin = 20.0;         ///< Mean contrast between a bit and its threshold, in grey levels.
};

/// Returns the names of the supported families: "tag36h11", "tag25h9", "tag16h5", ...
[[nodiscard]] const std::vector<std::string>& tag_families();

/// One tag in one picture.
struct TagDetection {
  int id = 0;
  int hamming = 0;
  double margin = 0.0;
  /// Corners of the black square, in pixels (frames.h), in the Tag frame's order: (-x, -y), (+x, -y), (+x, +y), (-x,
  /// +y); clockwise in the picture, starting at the upper left when the tag is upright.
  std::array<Eigen::Vector2d, 4> corners;
  /// Covariance of each corner, px². Without refinement, that of libapriltag's corners: 0.2 px in any direction.
  std::array<Eigen::Matrix2d, 4> covariance = {kUnrefined, kUnrefined, kUnrefined, kUnrefined};

  static inline const Eigen::Matrix2d kUnrefined = 0.04 * Eigen::Matrix2d::Identity();
};

/// AprilTag 3 (Wang and Olson, "AprilTag 2", IROS 2016; Krogius et al., "Flexible Layouts for Fiducial Tags", IROS
/// 2019), by libapriltag. Thread-bound: each thread needs its own. It keeps its worker threads between pictures.
class TagDetector {
 public:
  /// Makes a detector. Errors: kInvalidArgument if a setting is out of range, or the family is unknown.
  static Result<TagDetector> create(const DetectorSettings& settings);
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;
  ~TagDetector();

  /// Returns every tag that passes the settings, the largest first. An empty picture, or one too small for a tag,
  /// contains none. Errors: kInvalidArgument if a side exceeds kMaxSidePx, since libapriltag counts half pixels in 16
  /// bits.
  Result<std::vector<TagDetection>> detect(const GreyImage& picture);
  /// Same as detect(), for a part of the picture, which is clipped to the picture, with a decimation of its own: 1 to
  /// 8.
  Result<std::vector<TagDetection>> detect_in(const GreyImage& picture, const PixelRect& part, double decimate);
  static constexpr int kMaxSidePx = 16384;

 private:
  struct Library;
  TagDetector(std::unique_ptr<Library> library, DetectorSettings settings);
  std::unique_ptr<Library> library_;
  DetectorSettings settings_;
};

/// Sorts by size, the largest first.
void sort_by_size(std::vector<TagDetection>* tags);

/// Returns twice the signed area of the quadrilateral, positive if its corners run clockwise in the picture.
[[nodiscard]] double doubled_area_px2(const std::array<Eigen::Vector2d, 4>& corners);

}  // namespace cyclorama::tags
