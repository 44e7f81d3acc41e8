// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "drivers/input/input_steering.h"

namespace cyclorama::input {

/// An open input device. Thread-bound.
class InputDevice {
 public:
  virtual ~InputDevice() = default;
  [[nodiscard]] virtual const InputDescription& description() const = 0;
  /// Returns the next pending event, or nothing. Does not block. Errors: kUnavailable if the device was unplugged.
  virtual Result<std::optional<InputEvent>> next() = 0;
};

/// Access to the devices; replaced in tests.
struct InputDevices {
  std::function<std::vector<std::string>()> list;
  std::function<Result<std::unique_ptr<InputDevice>>(const std::string&)> open;
};

/// All input devices that can steer, including those plugged in later. Their commands add up. Thread-bound.
///
///   listed ── opens, can steer ──► open ── unplugged, or gone from the list ──► closed: its command ends
///      └───── cannot steer: ignored until it is gone from the list; cannot be opened: retried at the next scan
class InputWatch {
 public:
  explicit InputWatch(InputDevices devices) : devices_(std::move(devices)) {}

  static constexpr Duration kLook = std::chrono::seconds(1);
  /// Reads pending events and scans for devices every kLook. Call it about every 10 ms; does not block.
  void update(TimePoint now);
  [[nodiscard]] InputCommand command(TimePoint now) const;
  /// Returns InputSteering::take_steps() of all devices together.
  [[nodiscard]] int take_steps();
  /// Returns InputSteering::take_languages() of all devices together.
  [[nodiscard]] int take_languages();
  /// Returns whether Help was pressed on any keyboard since the last call.
  bool take_help() { return std::exchange(is_help_wanted_, false); }
  /// State in sentences for people: "gamepad 'Pad 3'", or a device that cannot be opened, with the reason.
  [[nodiscard]] std::vector<std::string> sentences() const;
  [[nodiscard]] std::size_t open_count() const { return open_.size(); }

 private:
  struct Open {
    std::unique_ptr<InputDevice> device;
    InputSteering steering;
  };
  void look();
  /// Returns false once the device is gone.
  bool read(Open* open, TimePoint now);
  InputDevices devices_;
  TimePoint looked_at_{};
  bool looked_ = false;
  bool is_help_wanted_ = false;
  std::map<std::string, Open> open_;
  std::set<std::string> useless_;
  std::map<std::string, std::string> failures_;
};

}  // namespace cyclorama::input
