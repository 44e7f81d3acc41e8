// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "appliance/calibrator/turntable_prompt.h"
#include "appliance/scan/calibration_run.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/inspection_service.h"

namespace cyclorama::calibrator {

/// What one calibration works with. Made for it and let go after it, so that the show comes back, and the camera and
/// the turntable are free for others between.
struct CalibrationDevices {
  std::unique_ptr<turntable::Turntable> turntable;
  std::unique_ptr<scan::ScanCamera> camera;
  std::unique_ptr<scan::ScanCamera> colour_camera;  ///< As ScanDevices has it. May be null.
  std::unique_ptr<scan::PatternScreen> screen;      ///< Last: it is let go first.
  scan::ScanSettings settings;                      ///< With this camera's lens.
};
using DeviceOpener = std::function<Result<CalibrationDevices>()>;

/// Calibrates when told to, one at a time. Thread-safe; a calibration runs in its call's thread.
class CalibratorService final : public wire::Calibrator::Service {
 public:
  /// `folder` holds the calibrations (calibration_file.h). Borrows `inspection` and `clock`.
  CalibratorService(Installation installation, std::filesystem::path folder, DeviceOpener opener, const Clock& clock,
                    InspectionService* inspection);

  /// Before the first call: what is let go of while a calibration runs is held by what `hold` returns.
  void hold_with(std::function<std::shared_ptr<void>()> hold) { hold_ = std::move(hold); }
  /// Before the first call: where its turntable asks. Borrowed.
  void set_prompt(TurntablePrompt* prompt) { prompt_ = prompt; }
  /// What else the process does, for its state: "keeps 3 projectors in place".
  void also(std::string sentence, bool is_healthy);
  /// Cancels what runs; later calls are refused. It ends within a picture.
  void stop();
  /// For people: "is calibrating: ...".
  [[nodiscard]] std::string state() const;

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateOrder* request,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override;
  grpc::Status Restore(grpc::ServerContext* context, const wire::RestoreOrder* request,
                       wire::RestoreAnswer* reply) override;
  grpc::Status Answer(grpc::ServerContext* context, const wire::AnswerOrder* request,
                      wire::AnswerReply* reply) override;
  Result<scan::CalibrationOutcome> calibrate(const wire::CalibrateOrder& order, const scan::ScanListener& listener,
                                             std::stop_token stop);
  void say(std::string sentence, bool is_healthy);
  void tell();

  const Installation installation_;
  const std::filesystem::path folder_;
  const DeviceOpener opener_;
  const Clock& clock_;
  InspectionService* inspection_;

  std::mutex busy_;  ///< Held by the one that works.
  mutable std::mutex mutex_;
  std::string state_;
  bool is_healthy_ = true;
  std::string also_;
  bool is_also_healthy_ = true;
  std::function<std::shared_ptr<void>()> hold_;
  TurntablePrompt* prompt_ = nullptr;  ///< Null: no turntable asks.
  std::stop_source stop_;
};

}  // namespace cyclorama::calibrator
