// SPDX-License-Identifier: Apache-2.0
/// Gamepads, keyboards and 3D mice, reduced to three numbers for the requested movement.
///
///              gamepad            keyboard             3D mouse (the cap)
///   forward    left stick up      Up, W / Down, S      pushed away
///   right      left stick right   D / A                pushed to the right
///   turn       right stick right  Right, E / Left, Q   twisted clockwise
///
///   next       right shoulder     Page Down            right button           of the tour's stops
///   previous   left shoulder      Page Up              left button            (presenters' clickers are keyboards)
///   language   upper button       L                    –                      of what is written on the wall
///   help       –                  F1, Help             –
///
/// Event codes are those of linux/input-event-codes.h. Nothing here accesses a device.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/base/clock.h"

namespace cyclorama::input {

/// An event as reported by the kernel.
struct InputEvent {
  std::uint16_t type = 0;
  std::uint16_t code = 0;
  std::int32_t value = 0;
};

struct AxisRange {
  std::int32_t min = 0;
  std::int32_t max = 0;
};

/// Capabilities that a device reports.
struct InputDescription {
  std::string name;
  std::set<int> keys;
  std::set<int> relative;
  std::map<int, AxisRange> absolute;
};

enum class InputKind { kGamepad, kKeyboard, kSpaceMouse };
/// Returns nothing for a device that cannot steer, such as a mouse or a power button.
[[nodiscard]] std::optional<InputKind> kind_of(const InputDescription& description);
[[nodiscard]] const char* to_text(InputKind kind);

/// Each component is in [-1, 1].
struct InputCommand {
  double forward = 0.0;
  double right = 0.0;
  double turn = 0.0;
  [[nodiscard]] bool is_rest() const { return forward == 0.0 && right == 0.0 && turn == 0.0; }
  friend bool operator==(const InputCommand&, const InputCommand&) = default;
};

/// State of one input device. A value.
class InputSteering {
 public:
  /// `description` must be of `kind`.
  InputSteering(InputKind kind, InputDescription description) : kind_(kind), description_(std::move(description)) {}

  [[nodiscard]] InputKind kind() const { return kind_; }
  [[nodiscard]] const std::string& name() const { return description_.name; }
  /// Updates the state; events without a meaning for steering are ignored.
  void take(const InputEvent& event, TimePoint at);
  [[nodiscard]] InputCommand command(TimePoint now) const;
  /// Returns how often "next" was pressed since the last call, less how often "previous" was. Holding a key counts
  /// once.
  [[nodiscard]] int take_steps() { return std::exchange(steps_, 0); }
  /// Returns how often the next language was requested since the last call.
  [[nodiscard]] int take_languages() { return std::exchange(languages_, 0); }
  /// Number of presses of Help or F1 so far.
  [[nodiscard]] unsigned help_presses() const { return help_presses_; }

  /// Time after which a relative axis counts as released: a 3D mouse that reports relative axes sends no event on
  /// release.
  static constexpr Duration kRelativeHeld = std::chrono::milliseconds(150);

 private:
  [[nodiscard]] double stick(int code) const;
  [[nodiscard]] double cap(int relative, int absolute, TimePoint now) const;
  [[nodiscard]] double keys(std::initializer_list<int> forth, std::initializer_list<int> back) const;

  struct Moved {
    std::int32_t value = 0;
    TimePoint at{};
  };
  InputKind kind_;
  InputDescription description_;
  std::set<int> pressed_;
  int steps_ = 0;
  int languages_ = 0;
  unsigned help_presses_ = 0;
  std::map<int, std::int32_t> absolute_;
  std::map<int, Moved> relative_;
};

}  // namespace cyclorama::input
