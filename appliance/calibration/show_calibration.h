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

/// Light of a channel for each code of 8 bits, in [0, 1].
using CodeLight = std::array<float, 256>;
[[nodiscard]] CodeLight gamma_light(double gamma);
/// In steps of 1/65535, as files keep it.
[[nodiscard]] CodeLight rounded_light(CodeLight light);

struct ShowProjector {
  std::string name;
  BrownParameters lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  std::array<CodeLight, 3> light{};             ///< As measured; gamma_light(2.2) will do.
  std::array<float, 3> grey{.21f, .72f, .07f};  ///< How bright a camera finds each channel.
  std::string unplaced{};  ///< Why nobody knows where it stands; its light is then nobody's. Empty: it is known.
};

struct ShowCamera {
  std::string name;
  BrownParameters lens;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;
  CodeLight light{};  ///< What falls on it, for each of its codes.
};

/// What the last calibration found out, and what the continuous one keeps true: where everything stands. A value.
struct ShowCalibration {
  Wall wall;
  Point<frame::Room> sweet_spot;
  std::vector<ShowProjector> projectors;
  std::vector<ShowCamera> cameras;  ///< That look at the show, each in its place.

  /// kInvalidArgument  no projector or no camera, or a lens that is none; says which.
  [[nodiscard]] Status validate() const;
};

/// The slope (x/z, y/z) that a lens images at a pixel, by Newton's method; nothing where it does not settle within 1e-9
/// pixels, as beyond the fold of a distortion.
[[nodiscard]] std::optional<Eigen::Vector2d> slope_at(const BrownParameters& lens, const Eigen::Vector2d& pixel);
/// Perhaps outside of the picture; nothing behind the lens.
[[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const BrownParameters& lens, const Eigen::Vector3d& point);
[[nodiscard]] bool contains(const BrownParameters& lens, const Eigen::Vector2d& pixel);

/// What a camera's pixel looks at on the wall continued past its edges.
[[nodiscard]] std::optional<Eigen::Vector3d> wall_seen_at(const ShowCalibration& room, const ShowCamera& camera,
                                                          const Eigen::Vector2d& pixel);
/// Where a projector's pixel lands, alike.
[[nodiscard]] std::optional<Eigen::Vector3d> wall_lit_at(const ShowCalibration& room, const ShowProjector& projector,
                                                         const Eigen::Vector2d& pixel);

}  // namespace cyclorama::calibration
