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
#include "common/base/liveness.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/inspection_service.h"

namespace cyclorama::calibrator {

/// Devices of one calibration. They are opened for it and released after it, so that the show returns, and that others
/// can use camera and turntable in between.
struct CalibrationDevices {
  std::unique_ptr<turntable::Turntable> turntable;
  std::unique_ptr<scan::ScanCamera> camera;
  std::unique_ptr<scan::ScanCamera> colour_camera;  ///< See ScanDevices; may be null.
  std::unique_ptr<scan::PatternScreen> screen;      ///< Last member, so that it is released first.
  scan::ScanSettings settings;                      ///< Includes the lens of this camera.
};
using DeviceOpener = std::function<Result<CalibrationDevices>()>;

/// Runs calibrations on request, one at a time. Thread-safe; a calibration runs in the thread of its call.
class CalibratorService final : public wire::Calibrator::Service {
 public:
  /// `folder` holds the calibrations (calibration_file.h). Borrows `inspection` and `clock`.
  CalibratorService(Installation installation, std::filesystem::path folder, DeviceOpener opener, const Clock& clock,
                    InspectionService* inspection);

  /// Sets a function whose result, while it exists, pauses other work; a calibration holds one. To be called before the
  /// first request.
  void hold_with(std::function<std::shared_ptr<void>()> hold) { hold_ = std::move(hold); }
  /// Sets the prompt that shows the questions of a manual turntable. Borrows it. To be called before the first request.
  void set_prompt(TurntablePrompt* prompt) { prompt_ = prompt; }
  /// Adds a sentence about the process's other work to the state, such as "keeps 3 projectors in place".
  void also(std::string sentence, bool is_healthy);
  /// Cancels a running calibration, which then ends within one picture; later calls are refused.
  void stop();
  /// Returns the state in words, such as "is calibrating: ...".
  [[nodiscard]] std::string state() const;
  /// False while a calibration has made no step for longer than its longest step takes: its thread or a device hangs.
  [[nodiscard]] bool moves_on() const { return liveness_.is_alive(clock_.now()); }

 private:
  grpc::Status Calibrate(grpc::ServerContext* context, const wire::CalibrateRequest* request,
                         grpc::ServerWriter<wire::CalibrateProgress>* writer) override;
  grpc::Status Restore(grpc::ServerContext* context, const wire::RestoreRequest* request,
                       wire::RestoreReply* reply) override;
  grpc::Status Answer(grpc::ServerContext* context, const wire::AnswerRequest* request,
                      wire::AnswerReply* reply) override;
  Result<scan::CalibrationOutcome> calibrate(const wire::CalibrateRequest& order, const scan::ScanListener& listener,
                                             std::stop_token stop);
  void say(std::string sentence, bool is_healthy);
  void tell();

  const Installation installation_;
  const std::filesystem::path folder_;
  const DeviceOpener opener_;
  const Clock& clock_;
  InspectionService* inspection_;

  std::mutex busy_;  ///< Held by the call that uses the devices.
  mutable std::mutex mutex_;
  std::string state_;
  bool is_healthy_ = true;
  std::string also_;
  bool is_also_healthy_ = true;
  std::function<std::shared_ptr<void>()> hold_;
  TurntablePrompt* prompt_ = nullptr;  ///< Null if no person turns the turntable.
  std::stop_source stop_;
  Liveness liveness_;
};

}  // namespace cyclorama::calibrator
