// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/camera/camera.h"
#include "drivers/camera/pace.h"
#include "drivers/simulated/camera/sensor.h"
#include "drivers/simulated/camera/simulation.h"
#include "drivers/simulated/camera/tag_painter.h"

namespace cyclorama::simulated {

/// Renders the pictures of a simulation. The exposure of picture n begins at time n / frames_per_second of the path;
/// the picture depends only on the simulation and n. Immutable; reentrant.
class SimulatedView {
 public:
  explicit SimulatedView(Simulation simulation);
  [[nodiscard]] GreyImage picture(std::uint64_t sequence) const;
  [[nodiscard]] const Simulation& simulation() const { return simulation_; }

 private:
  Simulation simulation_;
  TagPainter painter_;
  Image<float, 1> backdrop_;
  Sensor sensor_;
};

/// A real-time camera that sees a hand with a tag. Its users get only pixels, never the true poses. Thread-bound except
/// for id().
class SimulatedCamera final : public camera::Camera {
 public:
  /// `clock` must outlive the camera.
  SimulatedCamera(Simulation simulation, const Clock& clock);

  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override;
  /// A picture is ready at the end of its exposure.
  Result<std::shared_ptr<const camera::CameraFrame>> next_frame(TimePoint deadline) override;
  void stop() override { streaming_ = false; }

 private:
  std::string id_ = "simulated";
  SimulatedView view_;
  const Clock& clock_;
  Duration exposure_;
  camera::Pace pace_;
  std::optional<std::uint64_t> last_;
  bool streaming_ = false;
};

}  // namespace cyclorama::simulated
