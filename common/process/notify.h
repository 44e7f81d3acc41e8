// SPDX-License-Identifier: Apache-2.0
/// sd_notify(3): ready, status, watchdog, stopping. Without systemd, no call has any effect.
#pragma once

#include <string>

#include "common/base/clock.h"

namespace cyclorama {

/// Reports the state of the process to systemd. keep_alive() is to be called whenever the process has just proved that
/// it works. Thread-bound to the main loop.
class Notify {
 public:
  Notify();
  void ready();
  /// Reports that the start makes progress: the next starting(), or ready(), follows within `wait`.
  void starting(Duration wait);
  void status(const std::string& sentence);
  void stopping();
  /// True if keep_alive() would notify the watchdog now, for proofs that cost something.
  [[nodiscard]] bool is_due(TimePoint now) const { return period_ != Duration::zero() && now >= next_; }
  /// Notifies the watchdog, at most twice per watchdog period, however often it is called.
  void keep_alive(TimePoint now);

 private:
  Duration period_{};  ///< Zero without a watchdog.
  TimePoint next_{};
};

}  // namespace cyclorama
