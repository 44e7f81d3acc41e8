// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/scan/calibration_run.h"

#include <ctime>
#include <optional>

#include "appliance/calibrator/solve/calibration_file.h"

namespace cyclorama {
namespace {
constexpr double kScanPart = 0.9;  // Of the bar.
constexpr double kSolvePart = 0.98;
}  // namespace

Result<CalibrationOutcome> run_calibration(const Installation& installation, const ScanSettings& settings,
                                           const ScanDevices& devices, const std::filesystem::path& folder,
                                           const std::string& date, const Clock& clock, const ScanListener& listener,
                                           std::stop_token stop) {
  const auto tell = [&](const std::string& step, double fraction) {
    if (listener) listener({step, fraction, nullptr});
  };
  CalibrationOutcome outcome;
  TimePoint begun = clock.now();
  TRY_ASSIGN(WallScan scan, scan_wall(
                                installation, settings, devices, folder / "scan",
                                [&](const ScanProgress& progress) {
                                  if (!listener) return;
                                  listener({progress.step, kScanPart * progress.fraction, progress.newest});
                                },
                                stop));
  outcome.pictures = scan.pictures;
  outcome.retries = scan.retries;
  outcome.scan_s = to_seconds(clock.now() - begun);

  tell("finds out where everything is", kScanPart);
  begun = clock.now();
  // One that cannot be read is no reason to have none: it is only not compared with.
  std::optional<Calibration> previous;
  if (auto read = read_calibration(folder)) {
    previous = *std::move(read);
  } else if (read.error().code() != ErrorCode::kNotFound) {
    scan.remarks.push_back("the calibration of before was not compared with: " + read.error().message());
  }
  CalibrateOptions options;
  options.previous = previous ? &*previous : nullptr;
  TRY_ASSIGN(outcome.calibration, calibrate(scan.measurements, date, options));
  outcome.registration = measured_registration(scan.measurements, outcome.calibration);
  outcome.solve_s = to_seconds(clock.now() - begun);
  auto& remarks = outcome.calibration.remarks;
  remarks.insert(remarks.begin(), scan.remarks.begin(), scan.remarks.end());
  if (stop.stop_requested()) return cancelled();
  tell("writes the calibration", kSolvePart);
  TRY(save_calibration(folder, outcome.calibration));
  tell("is calibrated", 1.0);
  return outcome;
}

std::string calibration_date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H-%M-%SZ", &utc);
  return {text, length};
}

}  // namespace cyclorama
