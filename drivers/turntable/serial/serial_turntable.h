// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <numbers>

#include "drivers/turntable/serial/serial_port.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::turntable {

struct SerialTurntableOptions {
  std::filesystem::path device;  ///< Better /dev/serial/by-id/... than /dev/ttyUSB0, which may be another's tomorrow.
  int baud = 115200;
  char axis = 'X';
  double units_per_turn = 360.0;  ///< Of the controller's axis: 360 if it counts degrees. Negative: it turns left.
  TurnRange range{-std::numbers::pi, std::numbers::pi};
  double speed_rad_s = 0.35;
  double tolerance_rad = 1e-3;                     ///< It has arrived when it says that it is so near: 0.06 degrees.
  std::chrono::milliseconds answer_timeout{3000};  ///< Of a controller that is not busy. Many reset when opened: 2 s.
  std::chrono::milliseconds home_timeout{90000};
};

/// A motor behind a controller that speaks G-code; gcode.h has the words, docs/guides/turntable.md the wiring.
class SerialTurntable final : public Turntable {
 public:
  /// Asks for an answer and moves nothing. Errors as SerialPort::open(), and
  /// kTimedOut  nothing answers.   kBadData  what answers is no controller.   kInvalidArgument  options without sense.
  static Result<std::unique_ptr<Turntable>> open(const SerialTurntableOptions& options);
  /// kInvalidArgument  options without sense.
  static Status check(const SerialTurntableOptions& options);

  [[nodiscard]] const std::string& id() const override { return id_; }

 private:
  SerialTurntable(SerialPort port, const SerialTurntableOptions& options);
  Status move_home() override;
  Status move_to(double angle_rad) override;
  Result<double> ask_angle() override;

  /// Says a line and waits for its ok; `ret_position` gets the position if one came before.
  Status say(std::string_view command, std::chrono::milliseconds timeout,
             std::optional<double>* ret_position = nullptr);
  Status wake();
  /// After a stall, answers to what was given up may still come: asks for the position, and waits for that.
  Status find_step();

  SerialPort port_;
  SerialTurntableOptions options_;
  std::string id_;
  double last_angle_rad_ = 0.0;
};

}  // namespace cyclorama::turntable
