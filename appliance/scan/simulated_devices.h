// SPDX-License-Identifier: Apache-2.0
/// A simulated museum as a scan sees it. The turntable is drivers/simulated/turntable.
#pragma once

#include <string>

#include "appliance/scan/scan_devices.h"
#include "drivers/simulated/museum/simulated_museum.h"

namespace cyclorama::scan {

/// A dark head shows black: its lamp burns, and some of its light leaks, as in a museum. Afterwards all lamps are off:
/// a museum that is simulated for a calibration has no show. Borrows the museum for its whole life.
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

/// With its colour filters or, three times as fast, without. Another exposure takes it as long as it takes a camera
/// that must be opened anew for it. Borrows the museum for its whole life.
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
  double exposure_s_ = 0.0;  ///< Of the last photograph.
  simulated::SimulatedMuseum* museum_;
  PhotographColour colour_;
};

}  // namespace cyclorama::scan
