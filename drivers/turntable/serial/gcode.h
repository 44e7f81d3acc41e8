// SPDX-License-Identifier: Apache-2.0
/// What is said over the serial line, without a line: G-code as Marlin's firmware speaks it, of which Klipper and
/// others know the same part. Source: marlinfw.org/meta/gcode, and RepRap's "G-code" page, 2024.
///
///   we say         means                                        it answers
///   G90            angles are counted from home                 ok
///   G28 X          home the axis                                [echo:busy: processing]... ok
///   G0 X30 F1200   go to 30 units, 1200 units a minute          ok                            when it has begun
///   M400           wait until it stands                         [echo:busy: processing]... ok
///   M114           where is it?                                 X:30.00 Y:0.00 ... Count ...  then ok
///
/// `Error:...` and `!!` are errors, `start` is a controller that has begun anew, `Resend:` a line that it did not get
/// whole. Lines that begin with `echo:` or `//` are for people.
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
    kPosition,  ///< `position` is where the axis is, in its units.
    kBusy,      ///< It works, and asks for answer_deadline.
    kError,     ///< `text` says what.
    kRestart,   ///< It does not know where it stands any more.
    kResend,
    kChatter,
  };
  Kind kind = Kind::kChatter;
  double position = 0.0;
  std::string text;
};

/// One line without its end; an ending carriage return is no harm. `axis` is an upper-case letter.
[[nodiscard]] Answer parse_answer(std::string_view line, char axis);

/// Cuts bytes into lines. A value; thread-bound.
class LineCutter {
 public:
  void add(std::string_view bytes) { bytes_ += bytes; }
  /// The next whole line, without its end.
  std::optional<std::string> next();
  /// What is there has no end: this is no controller, or not its baud rate.
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
