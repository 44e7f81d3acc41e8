// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/board_search.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "appliance/camera_calibration/board_view.h"
#include "appliance/camera_calibration/chessboard.h"
#include "appliance/camera_calibration/procam_start.h"

namespace cyclorama::camera_calibration {
namespace {

constexpr std::size_t kTagsAround = 4;     // Number of nearest tags that predict a corner.
constexpr double kNearTags_squares = 2.3;  // Maximum distance of these tags' centres from the corner.

struct SeenTag {
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  std::array<Eigen::Vector2d, 4> board_m;
  std::array<Eigen::Vector2d, 4> camera_px;
};

std::vector<SeenTag> tags_of(const TagBoard& board, const std::vector<tags::TagDetection>& detections) {
  std::vector<SeenTag> tags;
  for (const tags::TagDetection& detection : detections) {
    const auto corners = board.tag_corners_m(detection.id);
    if (!corners) continue;
    SeenTag tag{Eigen::Vector2d::Zero(), *corners, detection.corners};
    for (const Eigen::Vector2d& corner : *corners) tag.middle_m += 0.25 * corner;
    tags.push_back(tag);
  }
  return tags;
}

struct Expected {
  Eigen::Vector2d position;
  double square_px = 0.0;
};

/// Predicts the pixel of a point of the board from the nearest tags; returns nothing if no tag is near.
std::optional<Expected> expected_at(const Eigen::Vector2d& at_m, double square_m, std::vector<SeenTag>* tags) {
  const auto distance = [&](const SeenTag& tag) { return (tag.middle_m - at_m).squaredNorm(); };
  const std::size_t count = std::min(kTagsAround, tags->size());
  std::partial_sort(tags->begin(), tags->begin() + static_cast<std::ptrdiff_t>(count), tags->end(),
                    [&](const SeenTag& a, const SeenTag& b) { return distance(a) < distance(b); });
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (std::size_t i = 0; i < count; ++i) {
    const SeenTag& tag = (*tags)[i];
    if (std::sqrt(distance(tag)) > kNearTags_squares * square_m) continue;
    from.insert(from.end(), tag.board_m.begin(), tag.board_m.end());
    to.insert(to.end(), tag.camera_px.begin(), tag.camera_px.end());
  }
  const auto h = homography(from, to);
  if (!h) return std::nullopt;
  const auto place_of = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (*h * p.homogeneous()).hnormalized();
  };
  Expected expected{place_of(at_m), 1e9};
  for (const Eigen::Vector2d& step : {Eigen::Vector2d(square_m, 0.0), Eigen::Vector2d(0.0, square_m)}) {
    expected.square_px = std::min(expected.square_px, (place_of(at_m + step) - expected.position).norm());
  }
  if (!expected.position.allFinite() || !std::isfinite(expected.square_px)) return std::nullopt;
  return expected;
}

Result<LensView> find_tag_board(const GreyImage& picture, const TagBoard& board, tags::TagDetector* detector) {
  TRY_ASSIGN(const std::vector<tags::TagDetection> detections, detector->detect(picture));
  std::vector<SeenTag> tags = tags_of(board, detections);
  LensView view;
  double min_patch_px = 1e9;
  for (int i = 0; i < board.corners(); ++i) {
    const auto expected = expected_at(board.corner_m(i), board.square_m, &tags);
    if (!expected) continue;
    constexpr double kRim_px = 4.0;
    const Eigen::Vector2d& at = expected->position;
    if (!(at.x() > kRim_px && at.y() > kRim_px && at.x() < picture.width() - kRim_px &&
          at.y() < picture.height() - kRim_px)) {
      continue;
    }
    view.board_m.push_back(board.corner_m(i));
    view.camera_px.push_back(at);
    min_patch_px = std::min(min_patch_px, expected->square_px);
  }
  if (view.board_m.size() < kMinCorners) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("{} tags and {} corners of the board are seen, {} corners are needed; bring it nearer, "
                             "light it evenly, and keep it still",
                             tags.size(), view.board_m.size(), kMinCorners));
  }
  // The search window must not include tags, which begin at this distance from a corner, in squares.
  const double clear = 0.5 * (1.0 - board.tag_m / board.square_m);
  const int half = std::clamp(static_cast<int>(0.9 * clear * min_patch_px), 2, 8);
  TRY_ASSIGN(const std::vector<Eigen::Vector2d> sharp, sharpened_corners(picture, view.camera_px, half));
  LensView found;
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    if (!sharp[i].allFinite()) continue;
    found.board_m.push_back(view.board_m[i]);
    found.camera_px.push_back(sharp[i]);
  }
  if (found.board_m.size() < kMinCorners) {
    return Error(ErrorCode::kNotFound, "the board's corners are blurred; keep it still, and light it more");
  }
  return found;
}

}  // namespace

Result<tags::TagDetector> make_board_detector() {
  tags::DetectorSettings settings;
  settings.decimate = 1.0;  // The tags of a board are small, and speed does not matter.
  return tags::TagDetector::create(settings);
}

Result<LensView> find_board(const GreyImage& picture, const BoardKind& kind, tags::TagDetector* detector) {
  if (!kind.is_chessboard) return find_tag_board(picture, kind.tags, detector);
  const int columns = kind.tags.columns - 1;
  const int rows = kind.tags.rows - 1;
  TRY_ASSIGN(std::vector<Eigen::Vector2d> corners, find_chessboard(picture, columns, rows));
  return LensView{{}, chessboard_corners(columns, rows, kind.tags.square_m), std::move(corners)};
}

}  // namespace cyclorama::camera_calibration
