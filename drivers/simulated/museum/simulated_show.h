// SPDX-License-Identifier: Apache-2.0
/// A museum during the show: fixed cameras look at the wall, somebody bumps a projector, visitors walk through the
/// light. It serves to test the continuous calibration. Contains the truth: see truth.h for its permitted users.
///
///     show(i, picture) ─▶ projector i ─ light ─▶ people ─▶ wall ⇄ wall ─▶ people ─▶ camera k ─▶ photograph(k, ...)
///                             ▲ move_projector()              set_ambient()            ▲ move_camera()
///
/// It has no clock: a picture is shown until the next one, and a photograph sees the current pictures. The optics are
/// those of SimulatedMuseum.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/simulated/museum/camera_table.h"
#include "drivers/simulated/museum/projector_light.h"
#include "drivers/simulated/museum/simulated_museum.h"
#include "drivers/simulated/museum/true_sensor.h"

namespace cyclorama::simulated {

/// A camera that watches the wall. Its optics are those of a calibration's camera, but without a rolling shutter.
struct FixedCamera {
  TrueCamera optics;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;
};

/// An upright cylinder of one colour, which shades the wall, hides it, and is lit by the projectors.
struct Visitor {
  double x_m = 0.0;
  double z_m = 0.0;
  double radius_m = 0.25;
  double height_m = 1.75;
  double albedo = 0.3;
};

/// Thread-bound. The same calls in the same order give the same photographs, for any number of threads.
class SimulatedShow {
 public:
  /// Errors: those of TrueMuseum::make(); kInvalidArgument also for a camera behind the wall.
  static Result<SimulatedShow> make(Installation installation, MuseumTruth truth, std::vector<FixedCamera> cameras,
                                    int threads = 1);

  /// Shows a picture; an empty one turns the lamp off. Initially all lamps are off. Errors: those of
  /// SimulatedMuseum::show().
  Status show(std::size_t projector, RgbImage picture);
  /// Preconditions: the projector exists; the camera exists.
  Status move_projector(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& T_room_projector);
  void move_camera(std::size_t camera, const RigidTransform<frame::Room, frame::Camera>& T_room_camera);
  void set_visitors(std::vector<Visitor> visitors);
  void set_ambient(const RoomColour& lux) { ambient_lux_ = lux; }

  /// Returns grey codes of 8 bits. Errors: kInvalidArgument if there is no such camera.
  Result<GreyImage> photograph(std::size_t camera, double exposure_s);

  [[nodiscard]] const TrueMuseum& truth() const { return museum_; }
  [[nodiscard]] const std::vector<FixedCamera>& cameras() const { return cameras_; }

 private:
  struct Eye {
    std::vector<Eigen::Vector3d> directions;
    std::vector<float> vignetting;
    TrueSensor sensor;
    std::optional<CameraTable> table;    ///< Table of the room without people.
    std::optional<CameraTable> peopled;  ///< Table of the room with people.
  };
  SimulatedShow(TrueMuseum museum, std::vector<FixedCamera> cameras, int threads);
  const CameraTable& table_of(std::size_t camera);
  [[nodiscard]] CameraTable with_visitors(const CameraTable& table, std::size_t camera) const;
  [[nodiscard]] std::vector<float> slow_light(const CameraChannel& channel);

  TrueMuseum museum_;
  std::vector<FixedCamera> cameras_;
  std::vector<Eye> eyes_;
  std::vector<ProjectorLight> lights_;
  std::vector<Visitor> visitors_;
  RoomColour ambient_lux_{};
  int threads_;
  std::uint64_t photographs_ = 0;
};

}  // namespace cyclorama::simulated
