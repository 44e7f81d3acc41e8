// SPDX-License-Identifier: Apache-2.0
/// sd_notify(3): ready, status, watchdog, stopping. Without systemd every call does nothing.
#pragma once

#include <string>

#include "common/base/clock.h"

namespace cyclorama {

/// Thread-bound: the main loop's. Call keep_alive() whenever the process has just proved that it works.
class Notify {
 public:
  Notify();
  void ready();
  /// Still starting, and getting on: the next word, or ready(), comes within `wait`.
  void starting(Duration wait);
  void status(const std::string& sentence);
  void stopping();
  /// At most twice per watchdog period, whatever the rate of calls.
  void keep_alive(TimePoint now);

 private:
  Duration period_{};  ///< Zero when no watchdog is set.
  TimePoint next_{};
};

}  // namespace cyclorama
