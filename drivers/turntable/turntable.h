// SPDX-License-Identifier: Apache-2.0
/// Turns the calibration's camera about an upright axis; independent of the kind of drive.
///
///              home()              turn_to()
///   Unhomed ──────────▶ Ready ──────────────────┐
///      ▲                  │ ▲                   │
///      │ stalled          │ └───────────────────┘
///      └──────────────────┤
///                         │ unplugged
///                         ▼
///                       Failed       every call returns kUnavailable from now on; make a new Turntable.
#pragma once

#include <string>

#include "common/base/result.h"

namespace cyclorama::turntable {

/// Permitted range of angles, limited by cables. Radians, positive to the right (clockwise from above).
struct TurnRange {
  double min_rad = 0.0;
  double max_rad = 0.0;
};

/// Interface to a turntable of any kind, for the calibrator. Thread-bound; calls block while the turntable moves.
///
/// Errors of every call: kTimedOut if the turntable stalled, that is, did not answer or did not arrive (free it and
/// call home() again); kBadData if the device is not a turntable or reports an error (call home() again); kUnavailable
/// once Failed (see the diagram).
class Turntable {
 public:
  virtual ~Turntable() = default;

  /// Identifier for people and for calibration.json.
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] TurnRange range() const { return range_; }
  [[nodiscard]] bool is_homed() const { return state_ == State::kReady; }

  /// Finds angle 0 and stops there.
  Status home();
  /// Moves to `angle_rad` and returns once the drive reports standstill. Errors: kInvalidArgument if the angle is out
  /// of range or not a number, or the turntable was not homed; in both cases it has not moved.
  Status turn_to(double angle_rad);
  /// Returns the angle as reported by the drive. Errors: kInvalidArgument if the turntable was not homed.
  Result<double> angle();

 protected:
  explicit Turntable(TurnRange range) : range_(range) {}
  Turntable(const Turntable&) = delete;
  Turntable& operator=(const Turntable&) = delete;

 private:
  enum class State { kUnhomed, kReady, kFailed };
  virtual Status move_home() = 0;
  virtual Status move_to(double angle_rad) = 0;
  virtual Result<double> ask_angle() = 0;
  /// Changes the state as in the diagram.
  Error failed(Error error);
  Status refuse_unless_ready() const;

  TurnRange range_;
  State state_ = State::kUnhomed;
};

}  // namespace cyclorama::turntable
