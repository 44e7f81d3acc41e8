// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "drivers/input/input_steering.h"

namespace cyclorama::input {

/// An open device. Thread-bound.
class InputDevice {
 public:
  virtual ~InputDevice() = default;
  [[nodiscard]] virtual const InputDescription& description() const = 0;
  /// The next event that is there; nothing: none is. Does not block. kUnavailable  it was pulled out.
  virtual Result<std::optional<InputEvent>> next() = 0;
};

/// Where devices are: tests have their own.
struct InputDevices {
  std::function<std::vector<std::string>()> list;
  std::function<Result<std::unique_ptr<InputDevice>>(const std::string&)> open;
};

/// All devices that steer, whenever they are plugged in or out. Several add up. Thread-bound.
///
///   listed ── opens, and steers ──► open ── pulled out, or gone from the list ──► closed: its command ends with it
///      └───── steers nothing: left alone until it is gone from the list; does not open: tried again at the next look
class InputWatch {
 public:
  explicit InputWatch(InputDevices devices) : devices_(std::move(devices)) {}

  static constexpr Duration kLook = std::chrono::seconds(1);
  /// Reads what there is, and looks for devices every kLook. Call it every 10 ms or so; it does not block.
  void update(TimePoint now);
  [[nodiscard]] InputCommand command(TimePoint now) const;
  /// For people: "gamepad 'Pad 3'"; which one cannot be opened, and why.
  [[nodiscard]] std::vector<std::string> sentences() const;
  [[nodiscard]] std::size_t open_count() const { return open_.size(); }

 private:
  struct Open {
    std::unique_ptr<InputDevice> device;
    InputSteering steering;
  };
  void look();
  /// False once the device is gone.
  static bool read(Open* open, TimePoint now);
  InputDevices devices_;
  TimePoint looked_at_{};
  bool looked_ = false;
  std::map<std::string, Open> open_;
  std::set<std::string> useless_;
  std::map<std::string, std::string> failures_;
};

}  // namespace cyclorama::input
