// SPDX-License-Identifier: Apache-2.0
/// What a camera is turned with while it looks at the wall, whatever moves it.
///
///              home()              turn_to()
///   Unhomed ──────────▶ Ready ──────────────────┐
///      ▲                  │ ▲                   │
///      │ stalled          │ └───────────────────┘
///      └──────────────────┤
///                         │ unplugged
///                         ▼
///                       Failed       every call returns kUnavailable for ever; make a new Turntable.
#pragma once

#include <string>

#include "common/base/result.h"

namespace cyclorama::turntable {

/// How far a turntable may turn: cables wind up. Radians, positive to the right (clockwise from above).
struct TurnRange {
  double min_rad = 0.0;
  double max_rad = 0.0;
};

/// Used by the calibrator, which does not know which kind it holds. Thread-bound; calls block while the turntable
/// moves.
///
/// In every call: kTimedOut     it stalled: it did not answer, or did not arrive. Free it and home() again.
///                kBadData      what answers is no turntable, or it reports an error. Home it again.
///                kUnavailable  Failed; see the diagram.
class Turntable {
 public:
  virtual ~Turntable() = default;

  /// For people and for calibration.json.
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] TurnRange range() const { return range_; }
  [[nodiscard]] bool is_homed() const { return state_ == State::kReady; }

  /// Finds angle 0 and stands there.
  Status home();
  /// Stands still at `angle_rad` when it returns, as far as it can tell.
  /// kInvalidArgument  the angle is out of range or no number, or it was not homed; it has not moved.
  Status turn_to(double angle_rad);
  /// Where it stands, as far as it can tell. kInvalidArgument  it was not homed.
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
  /// Follows the diagram.
  Error failed(Error error);
  Status refuse_unless_ready() const;

  TurnRange range_;
  State state_ = State::kUnhomed;
};

}  // namespace cyclorama::turntable
