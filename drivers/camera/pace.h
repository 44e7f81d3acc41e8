// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama::camera {

/// Schedule of a software camera's pictures: one per period; a late caller gets the newest, and no picture is delivered
/// twice.
struct Pace {
  TimePoint first_at{};  ///< Time at which picture 0 is ready.
  Duration period{};     ///< Greater than zero.

  [[nodiscard]] TimePoint ready_at(std::uint64_t sequence) const {
    return first_at + period * static_cast<Duration::rep>(sequence);
  }
  /// Returns the picture to deliver at `now` after `last`: the newest that is ready, or else the next one.
  [[nodiscard]] std::uint64_t next(TimePoint now, std::optional<std::uint64_t> last) const;
};

/// Waits on `clock` for the next picture, at most until `deadline`. Errors: kTimedOut if none was ready by then.
Result<std::uint64_t> wait_for_picture(const Pace& pace, std::optional<std::uint64_t> last, const Clock& clock,
                                       TimePoint deadline);

/// Precondition: rate is 0.01 to 1000 pictures per second.
[[nodiscard]] Duration period_of(double frames_per_second);

}  // namespace cyclorama::camera
