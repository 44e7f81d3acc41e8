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
  std::filesystem::path device;  ///< Prefer /dev/serial/by-id/..., since /dev/ttyUSB0 may be another device later.
  int baud = 115200;
  char axis = 'X';
  /// Units of the controller's axis per turn: 360 for degrees. Negative if the axis turns to the left.
  double units_per_turn = 360.0;
  TurnRange range{-std::numbers::pi, std::numbers::pi};
  double speed_rad_s = 0.35;
  double tolerance_rad = 1e-3;  ///< Distance from the target that counts as arrived: 0.06 degrees.
  /// Maximum time until an idle controller answers. Many controllers reset when the line is opened, which takes 2 s.
  std::chrono::milliseconds answer_timeout{3000};
  std::chrono::milliseconds home_timeout{90000};
};

/// A motor behind a G-code controller. gcode.h describes the protocol, docs/guides/turntable.md the wiring.
class SerialTurntable final : public Turntable {
 public:
  /// Opens the line and checks, without any movement, that the controller answers. Errors: those of SerialPort::open();
  /// kTimedOut if nothing answers; kBadData if the device is not a G-code controller; kInvalidArgument if an option is
  /// invalid.
  static Result<std::unique_ptr<Turntable>> open(const SerialTurntableOptions& options);
  /// Checks the options without opening the line. Errors: kInvalidArgument if an option is invalid.
  static Status check(const SerialTurntableOptions& options);

  [[nodiscard]] const std::string& id() const override { return id_; }

 private:
  SerialTurntable(SerialPort port, const SerialTurntableOptions& options);
  Status move_home() override;
  Status move_to(double angle_rad) override;
  Result<double> ask_angle() override;

  /// Sends a line and waits for its "ok"; `ret_position` receives the position if the controller reports one before the
  /// "ok".
  Status say(std::string_view command, std::chrono::milliseconds timeout,
             std::optional<double>* ret_position = nullptr);
  Status wake();
  /// Resynchronises after a stall, when late answers may still arrive: requests the position and waits for it.
  Status find_step();

  SerialPort port_;
  SerialTurntableOptions options_;
  std::string id_;
  double last_angle_rad_ = 0.0;
};

}  // namespace cyclorama::turntable
