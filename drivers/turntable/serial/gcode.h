// SPDX-License-Identifier: Apache-2.0
/// The protocol of the serial line, without I/O: G-code as in Marlin's firmware, in a subset that Klipper and others
/// share. Source: marlinfw.org/meta/gcode, and RepRap's "G-code" page, 2024.
///
///   command        meaning                                      answer
///   G90            absolute coordinates from home               ok
///   G28 X          home the axis                                [echo:busy: processing]... ok
///   G0 X30 F1200   go to 30 units, 1200 units a minute          ok                            when it has begun
///   M400           wait until the movement ends                 [echo:busy: processing]... ok
///   M114           report the position                          X:30.00 Y:0.00 ... Count ...  then ok
///
/// `Error:...` and `!!` are errors, `start` means that the controller was reset, `Resend:` requests a damaged line
/// again. Lines that begin with `echo:` or `//` are informative.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace cyclorama::gcode {

inline constexpr std::size_t kMaxLineLength = 512;

struct Answer {
  enum class Kind {
    kOk,
    kPosition,  ///< `position` is the axis position in its units.
    kBusy,      ///< Still working: the answer timeout starts again.
    kError,     ///< `text` has the message.
    kRestart,   ///< The controller was reset and has lost its position.
    kResend,
    kChatter,
  };
  Kind kind = Kind::kChatter;
  double position = 0.0;
  std::string text;
};

/// Parses one line without its end; a trailing carriage return is accepted. `axis` is an upper-case letter.
[[nodiscard]] Answer parse_answer(std::string_view line, char axis);

/// Splits bytes into lines. A value; thread-bound.
class LineCutter {
 public:
  void add(std::string_view bytes) { bytes_ += bytes; }
  /// Returns the next complete line, without its end.
  std::optional<std::string> next();
  /// True if the input has no line end: the device is not a controller, or the baud rate is wrong.
  [[nodiscard]] bool is_endless() const {
    return bytes_.size() > kMaxLineLength && bytes_.find('\n') == std::string::npos;
  }
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

[[nodiscard]] std::string home_command(char axis);
[[nodiscard]] std::string go_command(char axis, double units, double units_per_minute);

}  // namespace cyclorama::gcode
