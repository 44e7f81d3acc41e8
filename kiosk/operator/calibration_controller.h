// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/calibration.grpc.pb.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::operations {

/// Runs calibrations, or the location of the fixed cameras, on the calibrator, one at a time, and keeps the result of
/// the last one, so that a page can be closed and opened again in the meantime. Thread-safe. Threads: one while
/// something runs.
///
///   idle ──start──▶ running ──done──▶ done      done, failed, cancelled ──start──▶ running
///                     ├──error──▶ failed
///                     └──cancel──▶ cancelled
class CalibrationController {
 public:
  /// Errors: kInvalidArgument if the address is invalid. Does not connect yet.
  static Result<std::unique_ptr<CalibrationController>> make(const std::string& address);
  /// Cancels the running work, and waits for its end.
  ~CalibrationController();
  CalibrationController(const CalibrationController&) = delete;
  CalibrationController& operator=(const CalibrationController&) = delete;

  /// Errors: kBusy if other work is running.
  Status start(const wire::CalibrateRequest& order);
  /// Locates the fixed cameras by patterns; the remarks give the accuracy of each. Errors: kBusy if other work is
  /// running.
  Status place_cameras();
  /// Idempotent; the state becomes "cancelled" when the calibrator has stopped.
  void cancel();
  /// Answers the calibration's question. Errors: kNotFound if there is no open question; kUnavailable, kTimedOut.
  Status answer(const std::string& text);
  /// Restores the previous calibration and returns its date. Errors: kBusy if other work is running; kNotFound if there
  /// is none; kUnavailable, kTimedOut.
  Result<std::string> restore();

  /// Returns {"what": "wall" or "cameras", "state", "step", "fraction", "error", "date", "remarks": [],
  /// "registration_p95_px", "has_picture", "question"}.
  [[nodiscard]] std::string json() const;
  /// Returns the camera's newest picture as JPEG; empty: none.
  [[nodiscard]] std::string picture() const;

 private:
  explicit CalibrationController(const std::shared_ptr<grpc::Channel>& channel);
  Status begin(const char* what, const char* step, std::function<void(grpc::ClientContext*)> work);
  void calibrate(const wire::CalibrateRequest& order, grpc::ClientContext* context);
  void place(grpc::ClientContext* context);
  /// Ends the running work. Requires mutex_.
  void end(bool is_done, const grpc::Status& status, const char* doing);

  const std::unique_ptr<wire::Calibrator::Stub> calibrator_;
  const std::unique_ptr<wire::Healing::Stub> healing_;
  std::mutex ordering_;  ///< Guards the thread.
  std::thread thread_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::string what_ = "wall";
  std::string state_ = "idle";
  std::string error_;
  bool is_cancelled_ = false;
  wire::CalibrateProgress newest_;
  std::string jpeg_;
  std::shared_ptr<grpc::ClientContext> running_;  ///< Null: nothing runs.
};

/// A page's request: {"do": "start", "quick": false, "projector": "", "resume": false}, {"do": "answer", "text": ""},
/// {"do": "cancel"}, {"do": "restore"} or {"do": "place-cameras"}.
struct CalibrationRequest {
  enum class Kind { kStart, kAnswer, kCancel, kRestore, kPlaceCameras };
  Kind kind = Kind::kStart;
  wire::CalibrateRequest order;  ///< Set for kStart.
  std::string text;            ///< Set for kAnswer.
};
/// Errors: kBadData if the text is not the JSON of a request; the message names the mistake.
Result<CalibrationRequest> parse_calibration_request(std::string_view json);

}  // namespace cyclorama::operations
