// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <numbers>
#include <string>

#include "common/base/clock.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::turntable {

/// A person beside the turntable, at a terminal or with the operator's page.
class TurntableOperator {
 public:
  virtual ~TurntableOperator() = default;
  /// Returns the answer to the question: one line, without its end. Errors: kTimedOut if nobody answers; kUnavailable
  /// if the operator has left.
  virtual Result<std::string> answer(const std::string& question, std::chrono::milliseconds timeout) = 0;
};

/// An operator at a terminal: writes questions to one file descriptor and reads answers from the other. Borrows both.
class TerminalOperator final : public TurntableOperator {
 public:
  TerminalOperator(int in_fd, int out_fd) : in_fd_(in_fd), out_fd_(out_fd) {}
  Result<std::string> answer(const std::string& question, std::chrono::milliseconds timeout) override;

 private:
  int in_fd_;
  int out_fd_;
  std::string read_;
};

/// A turntable with a scale that a person turns. The operator may answer with the angle on the scale, which angle()
/// then returns; plain Enter confirms the requested angle, and `q` gives up.
class ManualTurntable final : public Turntable {
 public:
  explicit ManualTurntable(std::unique_ptr<TurntableOperator> operated_by,
                           TurnRange range = {-std::numbers::pi, std::numbers::pi},
                           std::chrono::milliseconds timeout = std::chrono::minutes(10));
  [[nodiscard]] const std::string& id() const override { return id_; }

 private:
  Status move_home() override;
  Status move_to(double angle_rad) override;
  Result<double> ask_angle() override { return angle_rad_; }
  Status ask_for(const std::string& what, double angle_rad);

  std::string id_ = "manual";
  std::unique_ptr<TurntableOperator> operator_;
  std::chrono::milliseconds timeout_;
  double angle_rad_ = 0.0;
};

}  // namespace cyclorama::turntable
