// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "appliance/tags/tag_detector.h"

namespace cyclorama::tags {

/// Finds tags in a stream of pictures as reliably as a search of every pixel would, in far less time:
///
///   ┌───────────────┐   full resolution   around each tag of the last pictures, and in one tile of the picture after
///   │   ┌──┐        │                     the other, so that all of it is searched within kJobs pictures
///   │   │▒▒│  ┌─┐   │   decimated         the whole picture: while a known tag is missing, while none is known, and
///   │   └──┘  │▒│   │                     twice in kJobs pictures
///   └───────────────┘
///
/// The cost of a visible wand is that of searching its surroundings and one tile. A small tag that decimation hides is
/// found when its tile is searched, and kept from then on. With decimation 1 the whole picture is always searched.
/// Thread-bound.
class TagSearch {
 public:
  /// The picture is cut into this many tiles, in rows of kTilesAcross.
  static constexpr int kTilesAcross = 4;
  static constexpr int kTiles = kTilesAcross * kTilesAcross;
  /// Each picture gets one of these jobs in turn: every tile, and twice the whole decimated picture, for new tags.
  static constexpr int kJobs = kTiles + 2;
  /// Number of pictures for which a lost tag is sought at its last position.
  static constexpr int kRemembered = 30;

  /// Errors: those of TagDetector::create().
  static Result<TagSearch> create(const DetectorSettings& settings);

  /// Returns every tag that is found, the largest first, without duplicates. Errors: those of TagDetector::detect().
  Result<std::vector<TagDetection>> search(const GreyImage& picture);

 private:
  struct Known {
    TagDetection tag;
    Eigen::Vector2d step = Eigen::Vector2d::Zero();  ///< Motion from one picture to the next, in pixels.
    int missed = 0;                                  ///< Number of pictures since the tag was last seen.
  };
  TagSearch(TagDetector detector, const DetectorSettings& settings)
      : detector_(std::move(detector)), decimate_(settings.decimate), tiles_(settings.tiles) {}
  [[nodiscard]] bool all_known_are_in(const std::vector<TagDetection>& found) const;
  void remember(const std::vector<TagDetection>& found);
  Status add_from(const GreyImage& picture, const PixelRect& part, double decimate,
                  std::vector<TagDetection>* ret_found);

  TagDetector detector_;
  double decimate_;
  bool tiles_;
  std::vector<Known> known_;
  int width_px_ = 0;  ///< Size of the last picture; a different size means a different camera.
  int height_px_ = 0;
  int next_job_ = 0;
};

}  // namespace cyclorama::tags
