// SPDX-License-Identifier: Apache-2.0
/// Compares decoded positions with an independent calibration from 63 corners per view: on the board, with the position
/// that its plane implies; elsewhere, with the line on which the position must lie, whatever the scene's shape.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/camera_calibration/procam_solve.h"
#include "appliance/structured_light/decode_quality.h"

namespace cyclorama {

/// Larger than structured_light::kGrossPx, since the calibration is extrapolated beyond the board.
inline constexpr double kGrossOffLinePx = 4.0;

struct TruthScore {
  int judged = 0;
  int wrong = 0;
  int on_board = 0;
  std::vector<double> board_distances;
  std::vector<double> line_distances;

  [[nodiscard]] double gross() const { return judged == 0 ? 0.0 : static_cast<double>(wrong) / judged; }
  [[nodiscard]] double board_median_px() const {
    if (board_distances.empty()) return 0.0;
    std::vector<double> sorted = board_distances;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }
};

/// Judges one pixel of every square of `every` x `every`.
inline void score_against(const structured_light::Decoded& decoded, const camera_calibration::BoardView& view,
                          const camera_calibration::ProcamCalibration& calibration, std::size_t pose, int every,
                          TruthScore* score) {
  const auto camera = calibration::BrownLens::from(calibration.camera);
  const auto projector = calibration::BrownLens::from(calibration.projector);
  CHECK(camera.has_value() && projector.has_value());
  const Eigen::Matrix3d R = calibration.T_projector_camera.rotation().toRotationMatrix();
  const Eigen::Vector3d t = calibration.T_projector_camera.translation();
  const auto& T_camera_board = calibration.T_camera_board.at(pose);
  const Eigen::Matrix3d board_axes = T_camera_board.rotation().toRotationMatrix();
  const Eigen::Vector3d board_origin = T_camera_board.translation();
  const Eigen::Vector2d max = view.board_m.back();
  for (int v = 0; v < decoded.fate.height(); v += every) {
    for (int u = 0; u < decoded.fate.width(); u += every) {
      if (*decoded.fate.at(u, v) != structured_light::PixelFate::kDecoded) continue;
      const calibration::SlopeAnswer slope = camera->slope_at({u + 0.5, v + 0.5});
      if (!slope) continue;
      const Eigen::Vector3d ray(slope.slope.x(), slope.slope.y(), 1.0);
      const Eigen::Vector2d position(static_cast<double>(decoded.position_px.at(u, v)[0]),
                                     static_cast<double>(decoded.position_px.at(u, v)[1]));
      const double depth = board_axes.col(2).dot(board_origin) / board_axes.col(2).dot(ray);
      const Eigen::Vector3d on_plane = board_axes.transpose() * (depth * ray - board_origin);
      if (on_plane.x() > 0.0 && on_plane.y() > 0.0 && on_plane.x() < max.x() && on_plane.y() < max.y()) {
        const auto expected = projector->pixel_of(R * (depth * ray) + t);
        if (!expected) continue;
        const double distance = (*expected - position).norm();
        score->board_distances.push_back(distance);
        ++score->judged;
        ++score->on_board;
        score->wrong += distance > structured_light::kGrossPx ? 1 : 0;
        continue;
      }
      const calibration::SlopeAnswer seen = projector->slope_at(position);
      if (!seen) continue;
      const Eigen::Vector3d line = t.cross(R * ray);
      const double distance = std::abs(line.dot(Eigen::Vector3d(seen.slope.x(), seen.slope.y(), 1.0))) /
                              line.head<2>().norm() * calibration.projector.focal_u_px;
      score->line_distances.push_back(distance);
      ++score->judged;
      score->wrong += distance > kGrossOffLinePx ? 1 : 0;
    }
  }
}

}  // namespace cyclorama
