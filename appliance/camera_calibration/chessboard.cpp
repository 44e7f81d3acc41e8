// SPDX-License-Identifier: Apache-2.0
#include "appliance/camera_calibration/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace cyclorama::camera_calibration {
namespace {

/// Returns the smallest distance between neighbouring corners.
double min_square(const std::vector<cv::Point2f>& corners, int columns) {
  double smallest = 1e9;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    if ((i + 1) % static_cast<std::size_t>(columns) != 0)
      smallest = std::min(smallest, cv::norm(corners[i + 1] - corners[i]));
    const std::size_t below = i + static_cast<std::size_t>(columns);
    if (below < corners.size()) smallest = std::min(smallest, cv::norm(corners[below] - corners[i]));
  }
  return smallest;
}

/// Between the dark and the bright squares of a board, in grey levels; less is noise.
constexpr int kMinContrast = 12;

/// Difference of the grey levels that a tenth of the pixels around a corner are below and above: the noise of single
/// pixels does not count, and any way in which the squares lie does.
int contrast_at(const GreyImage& photo, const Eigen::Vector2d& corner, int half_px) {
  const int x = static_cast<int>(corner.x());
  const int y = static_cast<int>(corner.y());
  std::vector<std::uint8_t> levels;
  for (int v = std::max(0, y - half_px); v <= std::min(photo.height() - 1, y + half_px); ++v) {
    for (int u = std::max(0, x - half_px); u <= std::min(photo.width() - 1, x + half_px); ++u)
      levels.push_back(*photo.at(u, v));
  }
  if (levels.empty()) return 0;
  std::ranges::sort(levels);
  const std::size_t tenth = levels.size() / 10;
  return levels[levels.size() - 1 - tenth] - levels[tenth];
}

}  // namespace

Result<std::vector<Eigen::Vector2d>> find_chessboard(const GreyImage& photo, int columns, int rows) {
  if (columns < 3 || rows < 3 || columns > 100 || rows > 100 || photo.empty()) {
    return Error(ErrorCode::kInvalidArgument, "a chessboard has 3 to 100 inner corners each way");
  }
  try {
    // The cast is needed because OpenCV has no read-only view of memory.
    const cv::Mat image(photo.height(), photo.width(), CV_8UC1,
                        const_cast<std::uint8_t*>(photo.data().data()));  // NOLINT
    std::vector<cv::Point2f> corners;
    // The sector-based detector is tried first: it is more accurate and finds blurred boards, but no boards at a steep
    // angle.
    if (!cv::findChessboardCornersSB(image, {columns, rows}, corners, cv::CALIB_CB_ACCURACY)) {
      corners.clear();
      if (!cv::findChessboardCorners(image, {columns, rows}, corners,
                                     cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
        return Error(ErrorCode::kNotFound,
                     "no chessboard of " + std::to_string(columns) + "x" + std::to_string(rows) +
                         " inner corners: all of it, with a white border, must be lit and in the picture");
      }
      const int half = std::clamp(static_cast<int>(min_square(corners, columns) / 6.0), 2, 11);
      cv::cornerSubPix(image, corners, {half, half}, {-1, -1},
                       cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-3));
    }
    std::vector<Eigen::Vector2d> result;
    for (const cv::Point2f& corner : corners) {
      if (!std::isfinite(corner.x) || !std::isfinite(corner.y))
        return Error(ErrorCode::kNotFound, "a corner of the chessboard is blurred away");
      result.emplace_back(static_cast<double>(corner.x) + 0.5, static_cast<double>(corner.y) + 0.5);
    }
    return result;
  } catch (const cv::Exception& problem) {
    return Error(ErrorCode::kSystem, std::string("OpenCV: ") + problem.what());
  }
}

Result<std::vector<Eigen::Vector2d>> sharpened_corners(const GreyImage& photo, std::vector<Eigen::Vector2d> corners,
                                                       int half_px) {
  if (photo.empty() || half_px < 2) return Error(ErrorCode::kInvalidArgument, "corners need a picture and a window");
  try {
    const cv::Mat image(photo.height(), photo.width(), CV_8UC1,
                        const_cast<std::uint8_t*>(photo.data().data()));  // NOLINT
    std::vector<cv::Point2f> positions;
    for (const Eigen::Vector2d& c : corners) {
      positions.emplace_back(static_cast<float>(c.x() - 0.5), static_cast<float>(c.y() - 0.5));
    }
    cv::cornerSubPix(image, positions, {half_px, half_px}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-3));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d moved(static_cast<double>(positions[i].x) + 0.5, static_cast<double>(positions[i].y) + 0.5);
      // Without contrast cornerSubPix() leaves a corner where it was, whatever the picture.
      const double way = (moved - corners[i]).cwiseAbs().maxCoeff();
      const bool is_seen = way < 0.9 * half_px && contrast_at(photo, moved, half_px) >= kMinContrast;
      corners[i] = is_seen ? moved : Eigen::Vector2d::Constant(std::nan(""));
    }
    return corners;
  } catch (const cv::Exception& problem) {
    return Error(ErrorCode::kSystem, std::string("OpenCV: ") + problem.what());
  }
}

}  // namespace cyclorama::camera_calibration
