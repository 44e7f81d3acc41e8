// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_case.h"

#include <ctime>
#include <numbers>

#include "appliance/scan/simulated_devices.h"
#include "drivers/simulated/museum/as_sold.h"
#include "drivers/simulated/turntable/simulated_turntable.h"

namespace cyclorama {
namespace {

/// A clock that counts this process's processor time.
class ProcessorClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override {
    const double seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds)));
  }
};

/// Adds up the exposure times.
class CountingCamera final : public scan::ScanCamera {
 public:
  CountingCamera(scan::ScanCamera* camera, double* exposed_s) : camera_(*camera), exposed_s_(*exposed_s) {}
  [[nodiscard]] const std::string& id() const override { return camera_.id(); }
  [[nodiscard]] int width_px() const override { return camera_.width_px(); }
  [[nodiscard]] int height_px() const override { return camera_.height_px(); }
  [[nodiscard]] bool has_colour() const override { return camera_.has_colour(); }
  [[nodiscard]] double code_step() const override { return camera_.code_step(); }
  Result<scan::ScanPhotograph> photograph(double exposure_s) override {
    exposed_s_ += exposure_s;
    return camera_.photograph(exposure_s);
  }

 private:
  scan::ScanCamera& camera_;
  double& exposed_s_;
};

}  // namespace

KnownCamera camera_of_preset(const std::string& name) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  if (name == "dome") return {92.0 * kDegree, 25.0 * kDegree};
  return {70.0 * kDegree, 0.0};
}

Result<ChainResult> run_chain(const ChainCase& chain, const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  std::filesystem::create_directories(folder, ignored);
  TRY_ASSIGN(simulated::Preset preset, simulated::make_preset(chain.name, chain.seed, chain.museum));
  for (const std::string& kind : chain.as_sold)
    TRY(simulated::add_as_sold(simulated::RandomStream(chain.seed), kind, &preset.truth));
  TRY_ASSIGN(simulated::SimulatedMuseum museum, simulated::SimulatedMuseum::make(preset.installation, preset.truth));
  scan::SimulatedPatternScreen screen(&museum);
  ChainResult result;
  scan::SimulatedScanCamera grey(&museum, scan::PhotographColour::kGrey);
  scan::SimulatedScanCamera colour(&museum, scan::PhotographColour::kColour);
  CountingCamera camera(&grey, &result.patterns_exposed_s);
  CountingCamera colour_camera(&colour, &result.light_exposed_s);
  simulated::SimulatedTurntable turntable(&museum);
  const KnownCamera known = camera_of_preset(chain.name);
  scan::ScanSettings settings;
  settings.camera = scan::data_sheet_lens(camera.width_px(), camera.height_px(), known.field_of_view_rad);
  settings.pitch_rad = known.pitch_rad;
  settings.view = chain.view;
  settings.directions = chain.directions;
  settings.with_wall = chain.with_wall;
  const ProcessorClock clock;
  const double museum_begun = museum.now_s();
  TRY_ASSIGN(result.outcome,
             scan::run_calibration(museum.installation(), settings, {screen, camera, turntable, &colour_camera}, folder,
                                   "2026-01-01T00-00-00Z", clock, {}, {}));
  result.museum_s = museum.now_s() - museum_begun;
  const calibration::Calibration& calibration = result.outcome.calibration;
  result.directions = calibration.turntable.angles_rad.size();
  // Projectors that are still warming up are judged as they are at the end.
  TRY_ASSIGN(const simulated::TrueMuseum truth,
             simulated::TrueMuseum::make(preset.installation, preset.truth.warmed_up(museum.now_s())));
  result.score = museum_score(
      truth,
      [&](std::size_t p, const Eigen::Vector2d& pixel) { return calibration.projectors[p].map.direction_at(pixel); },
      [&](std::size_t p, const Eigen::Vector2d& pixel) { return calibration.projectors[p].map.sigma_at(pixel); });
  if (result.outcome.light) {
    result.seams = seam_score(truth, *result.outcome.light);
    result.seams_before = seam_score(truth, *result.outcome.light, false);
    result.response_rms = response_rms(truth, *result.outcome.light);
  }
  if (!chain.keeps_folder) std::filesystem::remove_all(folder, ignored);
  return result;
}

}  // namespace cyclorama
