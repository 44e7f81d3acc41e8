// SPDX-License-Identifier: Apache-2.0
#include "common/process/notify.h"

#include <systemd/sd-daemon.h>

namespace cyclorama {

Notify::Notify() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) period_ = std::chrono::microseconds(period_us) / 2;
}

void Notify::ready() { sd_notify(0, "READY=1"); }
void Notify::starting(Duration wait) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(wait).count();
  sd_notify(0, ("EXTEND_TIMEOUT_USEC=" + std::to_string(us)).c_str());
}
void Notify::status(const std::string& sentence) { sd_notify(0, ("STATUS=" + sentence).c_str()); }
void Notify::stopping() { sd_notify(0, "STOPPING=1"); }

void Notify::keep_alive(TimePoint now) {
  if (!is_due(now)) return;
  next_ = now + period_;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace cyclorama
