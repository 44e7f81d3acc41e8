// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "drivers/turntable/serial/gcode.h"

namespace cyclorama::turntable {

/// A tty in raw mode: 8 bits, no parity, no flow control. Move-only; thread-bound.
class SerialPort {
 public:
  /// Errors: kNotFound if there is no such device; kBusy if another program of ours has it open; kInvalidArgument if it
  /// is not a serial line, or the rate is not one of those that Linux supports between 9600 and 921600.
  static Result<SerialPort> open(const std::filesystem::path& device, int baud);

  /// Errors: kUnavailable if unplugged; kTimedOut if the bytes are not accepted before the deadline.
  Status write_line(std::string_view line, TimePoint deadline);
  /// Returns a line without its end. Errors: kUnavailable if unplugged; kTimedOut if none came before the deadline;
  /// kBadData if there is no line end: the device is not a controller, or the baud rate is wrong.
  Result<std::string> read_line(TimePoint deadline);
  /// Discards unread input.
  void forget_input();

 private:
  explicit SerialPort(UniqueFd fd) : fd_(std::move(fd)) {}
  Status wait_for(short events, TimePoint deadline) const;

  UniqueFd fd_;
  gcode::LineCutter lines_;
};

}  // namespace cyclorama::turntable
