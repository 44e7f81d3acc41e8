// SPDX-License-Identifier: Apache-2.0
#include "common/process/stop_signal.h"

#include <poll.h>
#include <sys/signalfd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "common/base/check.h"

namespace cyclorama {

StopSignal::StopSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  CHECK(pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0);
  CHECK(std::signal(SIGPIPE, SIG_IGN) != SIG_ERR);
  fd_ = UniqueFd(signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK));
  CHECK(fd_.is_open());
}

bool StopSignal::wait_until(TimePoint deadline) const {
  // The signal is never read from the descriptor, which therefore stays readable.
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - SteadyClock().now());
    const auto timeout_ms = std::clamp<std::int64_t>(left.count(), 0, 1'000'000);
    pollfd entry{fd_.get(), POLLIN, 0};
    const int n = ::poll(&entry, 1, static_cast<int>(timeout_ms));
    if (n > 0) return true;
    if (n == 0 && SteadyClock().now() >= deadline) return false;
    CHECK(n >= 0 || errno == EINTR);
  }
}

}  // namespace cyclorama
