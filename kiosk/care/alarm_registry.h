// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::care {

using WallSeconds = std::chrono::sys_seconds;

/// A condition that people should know of, in English. A value.
struct Fault {
  std::string id;  ///< Same as the check's: "part-tour".
  std::string title;
  std::string sentence;
  std::string remedy;
  friend bool operator==(const Fault&, const Fault&) = default;
};

/// A message that a fault began, or that it is over.
struct Alarm {
  Fault fault;
  WallSeconds since{};  ///< Begin of the fault.
  WallSeconds at{};     ///< Time of this message.
  bool is_over = false;
  friend bool operator==(const Alarm&, const Alarm&) = default;
};

struct AlarmRules {
  std::chrono::seconds after{};
  bool is_quiet = false;
};

/// Decides when an alarm is due. Each fault gives one when it has lasted `after`, and one when it has been absent for
/// `after`, however often it flickers in between. In quiet hours nothing is due: what is still true after them is
/// reported then. Pure; its state outlives restarts as JSON. Thread-bound.
class AlarmRegistry {
 public:
  /// Takes the present faults, and returns the alarms that are due. Time that runs backwards, as when the clock is set,
  /// makes alarms late, but neither lost nor repeated.
  std::vector<Alarm> update(const std::vector<Fault>& present, const AlarmRules& rules, WallSeconds now);

  [[nodiscard]] std::string to_json() const;
  /// Replaces the state. Errors: kBadData with position and mistake; the state is then as before.
  Status read_json(std::string_view text, const std::string& name);

 private:
  struct Known {
    Fault fault;
    WallSeconds since{};
    WallSeconds seen{};
    bool is_reported = false;
  };
  std::map<std::string, Known> known_;
};

}  // namespace cyclorama::care
