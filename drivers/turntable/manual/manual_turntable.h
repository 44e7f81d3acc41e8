// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <numbers>
#include <string>

#include "common/base/clock.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::turntable {

/// Somebody beside the turntable: in front of a terminal, or of the operator page.
class TurntableOperator {
 public:
  virtual ~TurntableOperator() = default;
  /// One line, without its end. kTimedOut  nobody answers.     kUnavailable  nobody is there any more.
  virtual Result<std::string> answer(const std::string& question, std::chrono::milliseconds timeout) = 0;
};

/// At a terminal: asks on one file descriptor and reads a line from the other. Borrows both.
class TerminalOperator final : public TurntableOperator {
 public:
  TerminalOperator(int in_fd, int out_fd) : in_fd_(in_fd), out_fd_(out_fd) {}
  Result<std::string> answer(const std::string& question, std::chrono::milliseconds timeout) override;

 private:
  int in_fd_;
  int out_fd_;
  std::string read_;
};

/// A turntable with a scale that a person turns. The operator may answer with the angle that it really stands at, which
/// is then what angle() says; plain Enter means the one that was asked for, `q` gives up.
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
