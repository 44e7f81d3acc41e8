// SPDX-License-Identifier: Apache-2.0
/// The screen and the camera of a simulated museum. Its turntable is in drivers/simulated/turntable.
#pragma once

#include <string>

#include "appliance/scan/scan_devices.h"
#include "drivers/simulated/museum/simulated_museum.h"

namespace cyclorama::scan {

/// A dark head shows black with its lamp on, so that its black level remains, as in a real museum. The destructor turns
/// all lamps off, since a museum that is simulated for a calibration has no show. Borrows the museum.
class SimulatedPatternScreen final : public PatternScreen {
 public:
  explicit SimulatedPatternScreen(simulated::SimulatedMuseum* museum);
  ~SimulatedPatternScreen() override;
  SimulatedPatternScreen(const SimulatedPatternScreen&) = delete;
  SimulatedPatternScreen& operator=(const SimulatedPatternScreen&) = delete;

  Status show(std::size_t projector, const RgbImage& picture) override;

 private:
  void show_dark(std::size_t projector);
  simulated::SimulatedMuseum* museum_;
};

enum class PhotographColour { kGrey, kColour };

/// Takes photographs with colour filters or, three times as fast, without. A change of exposure takes as long as with a
/// camera that must be reopened. Borrows the museum.
class SimulatedScanCamera final : public ScanCamera {
 public:
  SimulatedScanCamera(simulated::SimulatedMuseum* museum, PhotographColour colour) : museum_(museum), colour_(colour) {}

  [[nodiscard]] const std::string& id() const override { return id_; }
  [[nodiscard]] int width_px() const override { return museum_->camera_width_px(); }
  [[nodiscard]] int height_px() const override { return museum_->camera_height_px(); }
  [[nodiscard]] bool has_colour() const override { return colour_ == PhotographColour::kColour; }
  [[nodiscard]] double code_step() const override { return 1.0 / ((1 << museum_->camera_bits()) - 1); }
  Result<ScanPhotograph> photograph(double exposure_s) override;

 private:
  std::string id_ = "simulated";
  double exposure_s_ = 0.0;  ///< Exposure of the last photograph.
  simulated::SimulatedMuseum* museum_;
  PhotographColour colour_;
};

}  // namespace cyclorama::scan
