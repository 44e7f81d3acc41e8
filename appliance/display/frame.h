// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/display/reprojection_mesh.h"
#include "common/base/clock.h"
#include "common/geometry/projection.h"
#include "common/image/pixel_rect.h"
#include "common/image/planar_picture.h"

namespace cyclorama::display {

inline constexpr std::int64_t kMaxShowAt_ns = std::int64_t{1} << 62;

/// Time from which a frame or heading is shown: a checked wire::ShowAt. With period 0 it is shown at once. The refresh
/// lies within kMaxShowAt_ns (146 years) of the clock's zero, so that nothing overflows.
struct ShowAt {
  std::int64_t refresh = 0;  ///< Number of the synchronised refresh.
  std::int64_t period_ns = 0;
  std::int64_t told_ns = 0;  ///< Time when the tour sent the schedule, on the tour's clock.
};

/// A whole picture, ready to be shown: every tile has come, and those that the heads show are decoded. A value; its
/// pixels are shared and never change.
struct DisplayFrame {
  std::uint64_t order = 0;   ///< Counts frames begun by this display; a greater value is newer, whatever `number` is.
  std::uint64_t number = 0;  ///< Number of the view; 0: the display made the picture itself.
  double heading_rad = 0.0;
  std::uint64_t cuts =
      0;  ///< Number of cuts before this frame, as the tour counts them; another number, another place.
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();  ///< Eye in the Scene frame.
  std::int64_t shutter_ns = 0;                      ///< See wire::View; 0 if keys steered.
  PictureShape shape;                               ///< Shape of one eye's picture, with its guard band.
  int stacked = 1;  ///< Number of eyes' pictures in `picture`; 2: the left eye's above the right eye's.
  std::shared_ptr<const PlanarPicture> picture;
  std::shared_ptr<const std::vector<PixelRect>> parts;  ///< Valid parts of the picture; null: the whole picture.
  /// Depth of the picture; null: the picture can only be shown from its own eye.
  std::shared_ptr<const ReprojectionMesh> mesh;
  std::string depth_trouble;    ///< Reason why the requested depth is missing; else empty.
  double turn_limit_rad = 0.0;  ///< Maximum turn either way for which the heads show only valid parts.
  std::size_t bytes = 0;        ///< Size of all tiles' JPEG data.
  std::uint32_t tiles = 0;      ///< Number of tiles received.
  std::uint32_t decoded = 0;    ///< Number of tiles that were decoded, because a head shows them.
  TimePoint begun_at{};
  TimePoint decoded_at{};
  ShowAt show_at;
  bool was_shown = false;
};

/// A pose of the visitor.
struct HeadingNow {
  double heading_rad = 0.0;
  std::int64_t shutter_ns = 0;
  ShowAt show_at{};
  std::uint64_t order = 0;  ///< A greater value is newer.
  /// Eye in the Scene frame: x, y, z; absent: the frame's eye. An array, because headings are passed on as plain bytes.
  std::optional<std::array<double, 3>> eye_m{};
  std::uint64_t cuts = 0;  ///< The heading applies to frames after as many cuts.
};

}  // namespace cyclorama::display
