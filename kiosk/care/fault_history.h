// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/care/alarm_registry.h"

namespace cyclorama::care {

/// The museum's last faults and their ends, whether somebody gets alarms or not. Pure; its state outlives restarts as
/// JSON. Thread-bound.
class FaultHistory {
 public:
  static constexpr std::size_t kMaxEvents = 100;

  /// Takes the present faults and warnings. Returns true if there is a new event.
  bool update(const std::vector<Fault>& present, WallSeconds now);
  /// The newest event is the last.
  [[nodiscard]] const std::deque<Alarm>& events() const { return events_; }

  [[nodiscard]] std::string to_json() const;
  /// Replaces the state. Errors: kBadData with position and mistake; the state is then as before.
  Status read_json(std::string_view text, const std::string& name);

 private:
  AlarmRegistry known_;
  std::deque<Alarm> events_;
};

}  // namespace cyclorama::care
