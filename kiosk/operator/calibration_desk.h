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

namespace cyclorama {

/// Orders calibrations of the calibrator, or that it finds out where the fixed cameras stand, one at a time, and
/// remembers how the last one went, so that a page may be closed and opened again meanwhile. Thread-safe. Threads: one
/// while something runs.
///
///   idle ──start──▶ running ──done──▶ done      done, failed, cancelled ──start──▶ running
///                     ├──error──▶ failed
///                     └──cancel──▶ cancelled
class CalibrationDesk {
 public:
  /// kInvalidArgument  the address is none. Does not dial yet.
  static Result<std::unique_ptr<CalibrationDesk>> make(const std::string& address);
  /// Cancels what runs, and waits for it.
  ~CalibrationDesk();
  CalibrationDesk(const CalibrationDesk&) = delete;
  CalibrationDesk& operator=(const CalibrationDesk&) = delete;

  /// kBusy  one runs already.
  Status start(const wire::CalibrateOrder& order);
  /// The fixed cameras' places, by patterns; the remarks say how well each is known. kBusy  something runs already.
  Status place_cameras();
  /// Idempotent; the state becomes "cancelled" when the calibrator has heard it.
  void cancel();
  /// To what the calibration asks. kNotFound  it asks nothing (any more).     kUnavailable, kTimedOut
  Status answer(const std::string& text);
  /// The calibration of before; its date. kBusy  one runs.     kNotFound  there is none.     kUnavailable, kTimedOut
  Result<std::string> restore();

  /// {"what": "wall" or "cameras", "state", "step", "fraction", "error", "date", "remarks": [], "registration_p95_px",
  /// "has_picture", "question"}
  [[nodiscard]] std::string json() const;
  /// The camera's newest picture, as JPEG; empty: none.
  [[nodiscard]] std::string picture() const;

 private:
  explicit CalibrationDesk(const std::shared_ptr<grpc::Channel>& channel);
  Status begin(const char* what, const char* step, std::function<void(grpc::ClientContext*)> work);
  void calibrate(const wire::CalibrateOrder& order, grpc::ClientContext* context);
  void place(grpc::ClientContext* context);
  /// The caller holds mutex_.
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

/// {"do": "start", "quick": false, "projector": "", "resume": false}, {"do": "answer", "text": ""}, {"do": "cancel"},
/// {"do": "restore"} or {"do": "place-cameras"}.
struct CalibrationWish {
  enum class Kind { kStart, kAnswer, kCancel, kRestore, kPlaceCameras };
  Kind kind = Kind::kStart;
  wire::CalibrateOrder order;  ///< Of kStart.
  std::string text;            ///< Of kAnswer.
};
/// kBadData  not such JSON: the message names what.
Result<CalibrationWish> parse_calibration_wish(std::string_view json);

}  // namespace cyclorama
