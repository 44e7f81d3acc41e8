// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "drivers/turntable/serial/gcode.h"

namespace cyclorama::turntable {

/// A tty, as 8 bits without parity, flow control or any change to bytes. Move-only; thread-bound.
class SerialPort {
 public:
  /// kNotFound         no such device.
  /// kBusy             another program of ours holds it.
  /// kInvalidArgument  it is no serial line, or no rate that Linux has: 9600 to 921600.
  static Result<SerialPort> open(const std::filesystem::path& device, int baud);

  /// kUnavailable  unplugged.     kTimedOut  it does not take them before the deadline.
  Status write_line(std::string_view line, TimePoint deadline);
  /// Without its end. kUnavailable  unplugged.     kTimedOut  none before the deadline.
  /// kBadData  bytes without an end: no controller, or another baud rate.
  Result<std::string> read_line(TimePoint deadline);
  /// Drops what has come and was not read.
  void forget_input();

 private:
  explicit SerialPort(UniqueFd fd) : fd_(std::move(fd)) {}
  Status wait_for(short events, TimePoint deadline) const;

  UniqueFd fd_;
  gcode::LineCutter lines_;
};

}  // namespace cyclorama::turntable
