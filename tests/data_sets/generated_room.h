// SPDX-License-Identifier: Apache-2.0
/// Rooms with exact geometry, and the measurements of a camera on a turntable in them: projectors with lenses, a wall,
/// noise, gross errors. It shares no formula with the solver: walls are implicit and intersected by bisection, lenses
/// are inverted by iteration. Purely geometric; drivers/simulated/museum takes photographs instead.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "appliance/solve/measurements.h"

namespace cyclorama {

enum class RoomKind { kPlane, kCylinder, kTiltedCylinder, kUnevenCylinder, kCorner, kDome, kBumpy };
inline constexpr RoomKind kRoomKinds[] = {RoomKind::kPlane,          RoomKind::kCylinder, RoomKind::kTiltedCylinder,
                                          RoomKind::kUnevenCylinder, RoomKind::kCorner,   RoomKind::kDome,
                                          RoomKind::kBumpy};
[[nodiscard]] const char* name_of(RoomKind kind);

struct RoomPlan {
  RoomKind kind = RoomKind::kCylinder;
  unsigned seed = 1;
  int projectors = 3;
  double arc_rad = 2.2;        ///< Angle of the wall from the sweet spot: 126 degrees.
  double half_height_m = 1.4;  ///< Extent of the wall above and below the eye.
  double radius_m = 4.0;       ///< Radius, or distance of a flat wall.
  double overlap = 0.15;       ///< Fraction of a projector's width shared with each neighbour.
  double throw_ratio = 0.0;    ///< Distance over width; 0 for projectors above the visitor.
  double noise_px = 0.2;
  double outliers = 0.005;
  double turntable_sigma_rad = 3e-4;
  double turntable_step_rad = 0.55;
  Eigen::Vector3d camera_offset_m{0.003, 0.0, 0.006};  ///< Right, (unused), forward.
  double camera_lens_error = 1.0;                      ///< In sigmas of the lens prior given to the solver.
  int stride_px = 8;                                   ///< Approximate stride between measured projector pixels.
  double projector_k1 = -0.02;
  double camera_megapixels = 2.304;  ///< 1920 x 1200; the field of view is independent of it.
  double person_rad = 0.0;   ///< Width of a person in each direction; half of the correspondences there are wrong.
  double aim_off_rad = 0.0;  ///< Angle between a projector's axis and its lit area: grazing light.
};

/// A value.
class GeneratedRoom {
 public:
  explicit GeneratedRoom(const RoomPlan& plan);

  /// Measurements for the solver; equal for equal plans.
  [[nodiscard]] solve::Measurements measurements() const;
  /// Returns the direction from the sweet spot to the wall point that a projector's pixel lights; a unit vector.
  /// Nothing beside the wall.
  [[nodiscard]] std::optional<Eigen::Vector3d> view_direction_of(std::size_t projector,
                                                                 const Eigen::Vector2d& pixel) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> wall_point_of(std::size_t projector, const Eigen::Vector2d& pixel) const;
  /// Returns the pixel of a projector that lights a point; nothing outside its picture.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_lighting(std::size_t projector,
                                                              const Eigen::Vector3d& point) const;
  [[nodiscard]] std::size_t projectors() const { return projectors_.size(); }
  [[nodiscard]] const RoomPlan& plan() const { return plan_; }

  static constexpr int kWidth_px = 1920;
  static constexpr int kHeight_px = 1080;

 private:
  struct Lens {
    double focal_px = 1.0;
    double centre_u_px = 0.0;
    double centre_v_px = 0.0;
    double k1 = 0.0;
    double k2 = 0.0;
  };
  struct Device {
    Lens lens;
    Eigen::Matrix3d axes;  ///< Columns: right, down, forward.
    Eigen::Vector3d position;
  };
  static Eigen::Vector2d through(const Lens& lens, const Eigen::Vector3d& point);
  static Eigen::Vector3d ray_of(const Lens& lens, const Eigen::Vector2d& pixel);
  [[nodiscard]] std::optional<Eigen::Vector3d> hit(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;
  void place_projectors(std::mt19937* random);
  [[nodiscard]] Device camera_at(double angle_rad) const;

  RoomPlan plan_;
  /// Positive in front of the wall, negative behind it.
  std::function<double(const Eigen::Vector3d&)> before_;
  std::vector<Device> projectors_;
  std::vector<double> told_angles_;
  std::vector<double> angles_;
  Lens camera_lens_;
  int camera_width_px_ = 0;
  int camera_height_px_ = 0;
  double pitch_ = 0.0;
  double roll_ = 0.0;
};

/// Registration of maps where projectors overlap, and their true error: distances on the wall, in projector pixels. The
/// maps' common heading and tilt are aligned with the truth first and do not count.
struct RegistrationScore {
  double mean_px = 0.0;
  double p95_px = 0.0;
  double max_px = 0.0;
  std::size_t correspondences = 0;  ///< Number in overlaps.
  double true_mean_px = 0.0;
  double true_p95_px = 0.0;
  double true_max_px = 0.0;
  std::size_t missing = 0;  ///< Pixels that light the wall but have no direction.
  std::size_t lit = 0;      ///< Pixels that light the wall.
};
using DirectionOf = std::function<std::optional<Eigen::Vector3d>(std::size_t projector, const Eigen::Vector2d& pixel)>;
[[nodiscard]] RegistrationScore registration_score(const GeneratedRoom& room, const DirectionOf& mapped);

}  // namespace cyclorama
