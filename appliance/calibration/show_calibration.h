// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/brown_model.h"
#include "common/base/result.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/wall.h"

namespace cyclorama::calibration {

/// Light of a channel, in [0, 1], for each 8-bit code.
using CodeLight = std::array<float, 256>;
[[nodiscard]] CodeLight gamma_light(double gamma);
/// Rounds to steps of 1/65535, the resolution of the files.
[[nodiscard]] CodeLight rounded_light(CodeLight light);

struct ShowProjector {
  std::string name;
  BrownParameters lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  std::array<CodeLight, 3> light{};             ///< Measured response; gamma_light(2.2) is an adequate substitute.
  std::array<float, 3> grey{.21f, .72f, .07f};  ///< Response of a grey camera to each channel.
  /// Reason why the pose is unknown; the position of the projector's light is then too uncertain to use. Empty: it is
  /// known.
  std::string unplaced{};
};

struct ShowCamera {
  std::string name;
  BrownParameters lens;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;
  CodeLight light{};  ///< Incident light for each code of the camera.
};

/// Poses of all projectors and fixed cameras: the result of the last calibration, kept up to date by the continuous
/// calibration. A value.
struct ShowCalibration {
  Wall wall;
  Point<frame::Room> sweet_spot;
  std::vector<ShowProjector> projectors;
  std::vector<ShowCamera> cameras;  ///< Fixed cameras that watch the show.

  /// Errors: kInvalidArgument, with the name, if there is no projector or no camera, or a lens is invalid.
  [[nodiscard]] Status validate() const;
};

/// Returns the slope (x/z, y/z) that a lens images at a pixel, by Newton's method; empty if it does not converge to
/// within 1e-9 pixels, for example beyond the fold of the distortion.
[[nodiscard]] std::optional<Eigen::Vector2d> slope_at(const BrownParameters& lens, const Eigen::Vector2d& pixel);
/// Returns the pixel of a point, which may be outside the picture; empty if the point is behind the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const BrownParameters& lens, const Eigen::Vector3d& point);
[[nodiscard]] bool contains(const BrownParameters& lens, const Eigen::Vector2d& pixel);

/// Returns the point that a camera's pixel sees on the wall, which is extended beyond its edges.
[[nodiscard]] std::optional<Eigen::Vector3d> wall_seen_at(const ShowCalibration& room, const ShowCamera& camera,
                                                          const Eigen::Vector2d& pixel);
/// Returns the point that a projector's pixel lights on the extended wall.
[[nodiscard]] std::optional<Eigen::Vector3d> wall_lit_at(const ShowCalibration& room, const ShowProjector& projector,
                                                         const Eigen::Vector2d& pixel);

}  // namespace cyclorama::calibration
