// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama::node {

/// Calls `fetch`, with growing delays, until it succeeds or fails for a reason that does not pass by itself. `report`
/// receives each error that leads to another call. `cancelled` is called often, from this thread. Errors: those of
/// `fetch`; kUnavailable if cancelled. Blocks.
template <typename Fetch>
auto retried(const Fetch& fetch, const std::function<void(const Error&)>& report,
             const std::function<bool()>& cancelled) -> decltype(fetch()) {
  constexpr Duration kMaxDelay = std::chrono::seconds(2);
  constexpr Duration kLook = std::chrono::milliseconds(50);
  const SteadyClock clock;
  for (Duration delay = std::chrono::milliseconds(100);; delay = std::min(2 * delay, kMaxDelay)) {
    auto result = fetch();
    if (result) return result;
    const ErrorCode code = result.error().code();
    if (code != ErrorCode::kUnavailable && code != ErrorCode::kTimedOut && code != ErrorCode::kBusy) return result;
    report(result.error());
    const TimePoint end = clock.now() + delay;
    while (clock.now() < end && !cancelled()) clock.wait_until(std::min(end, clock.now() + kLook));
    if (cancelled()) {
      return Error(ErrorCode::kUnavailable, "given up: the coordinator is gone, or no longer needs the file");
    }
  }
}

}  // namespace cyclorama::node
