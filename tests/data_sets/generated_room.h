// SPDX-License-Identifier: Apache-2.0
/// Rooms whose geometry is exact, and what a camera on a turntable would measure in them: projectors with lenses, a
/// wall, noise, gross errors. Shares no formula with the solver: walls are implicit and hit by bisection, lenses are
/// inverted by iteration. Made by geometry alone; drivers/simulated/museum takes photographs instead.
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
  double arc_rad = 2.2;        ///< Of the wall, as the sweet spot sees it: 126 degrees.
  double half_height_m = 1.4;  ///< The wall ends so far above and below the eye.
  double radius_m = 4.0;       ///< Or distance.
  double overlap = 0.15;       ///< Of a projector's width with each neighbour's.
  double throw_ratio = 0.0;    ///< Distance over width; 0: from above the visitor.
  double noise_px = 0.2;
  double outliers = 0.005;
  double turntable_sigma_rad = 3e-4;
  double turntable_step_rad = 0.55;
  Eigen::Vector3d camera_offset_m{0.003, 0.0, 0.006};  ///< Right, (unused), forward.
  double camera_lens_error = 1.0;                      ///< In sigmas of what the solver is told of the camera's lens.
  int stride_px = 8;                                   ///< Of the projector's pixels that are measured, about.
  double projector_k1 = -0.02;
  double camera_megapixels = 2.304;  ///< 1920 x 1200; the lens sees the same field.
  double person_rad = 0.0;   ///< So wide somebody walks through each direction: half of what was there is wrong.
  double aim_off_rad = 0.0;  ///< Projectors look so far aside of what they light: grazing light.
};

/// A value.
class GeneratedRoom {
 public:
  explicit GeneratedRoom(const RoomPlan& plan);

  /// What the solver gets; the same for the same plan.
  [[nodiscard]] solve::Measurements measurements() const;
  /// What the eye at the sweet spot sees where a projector's pixel lands; a unit vector. Nothing beside the wall.
  [[nodiscard]] std::optional<Eigen::Vector3d> view_direction_of(std::size_t projector,
                                                                 const Eigen::Vector2d& pixel) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> wall_point_of(std::size_t projector, const Eigen::Vector2d& pixel) const;
  /// The pixel of a projector that lights a point; nothing outside of its picture.
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
  /// Positive before the wall, negative behind it.
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

/// How well maps fit together where projectors overlap, and how true they are: distances on the wall, in projector
/// pixels. The maps' own heading and tilt do not count against truth: they are turned onto it first.
struct RegistrationScore {
  double mean_px = 0.0;
  double p95_px = 0.0;
  double max_px = 0.0;
  std::size_t correspondences = 0;  ///< In overlaps.
  double true_mean_px = 0.0;
  double true_p95_px = 0.0;
  double true_max_px = 0.0;
  std::size_t missing = 0;  ///< Pixels that light the wall and have no direction.
  std::size_t lit = 0;      ///< Pixels that light the wall.
};
using DirectionOf = std::function<std::optional<Eigen::Vector3d>(std::size_t projector, const Eigen::Vector2d& pixel)>;
[[nodiscard]] RegistrationScore registration_score(const GeneratedRoom& room, const DirectionOf& mapped);

}  // namespace cyclorama
