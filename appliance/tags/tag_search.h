// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "appliance/tags/tag_detector.h"

namespace cyclorama::tags {

/// Finds tags in a stream of pictures, in far less time than a search of every pixel takes and as surely:
///
///   ┌───────────────┐   full resolution   around each tag of the last pictures, and in one tile of the picture after
///   │   ┌──┐        │                     the other, so that every place is searched within kJobs pictures
///   │   │▒▒│  ┌─┐   │   decimated         the whole picture: while a known tag is missing, while none is known, and
///   │   └──┘  │▒│   │                     twice in kJobs pictures
///   └───────────────┘
///
/// A wand that is seen costs its surroundings and a tile; a small tag that decimation hides is found at the latest with
/// its tile, and kept from then on. With decimation 1 the whole picture is searched always. Thread-bound.
class TagSearch {
 public:
  /// The picture is cut into this many tiles, in rows of kTilesAcross.
  static constexpr int kTilesAcross = 4;
  static constexpr int kTiles = kTilesAcross * kTilesAcross;
  /// One for each picture in turn: every tile, and twice the whole picture decimated, for what came newly.
  static constexpr int kJobs = kTiles + 2;
  /// So many pictures a tag is looked for where it was.
  static constexpr int kRemembered = 30;

  /// kInvalidArgument  as TagDetector::create().
  static Result<TagSearch> create(const DetectorSettings& settings);

  /// Every tag that is found, the largest first, each once. Errors as TagDetector::detect().
  Result<std::vector<TagDetection>> search(const GreyImage& picture);

 private:
  struct Known {
    TagDetection tag;
    Eigen::Vector2d step = Eigen::Vector2d::Zero();  ///< How far it moved from picture to picture.
    int missed = 0;                                  ///< Pictures since it was seen.
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
  int width_px_ = 0;  ///< Of the last picture: another size is another camera.
  int height_px_ = 0;
  int next_job_ = 0;
};

}  // namespace cyclorama::tags
