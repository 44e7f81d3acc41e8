// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama::camera {

/// When a camera that is made of software has its pictures: one every period, the newest for a late caller, and none
/// twice.
struct Pace {
  TimePoint first_at{};  ///< Picture 0 is ready then.
  Duration period{};     ///< More than zero.

  [[nodiscard]] TimePoint ready_at(std::uint64_t sequence) const {
    return first_at + period * static_cast<Duration::rep>(sequence);
  }
  /// The picture to deliver at `now` after `last`: the newest that is ready, or else the next one.
  [[nodiscard]] std::uint64_t next(TimePoint now, std::optional<std::uint64_t> last) const;
};

/// Waits on `clock` for the picture that is due, at most until `deadline`. kTimedOut  none was ready by then.
Result<std::uint64_t> wait_for_picture(const Pace& pace, std::optional<std::uint64_t> last, const Clock& clock,
                                       TimePoint deadline);

/// Precondition: rate is 0.01 to 1000 pictures per second.
[[nodiscard]] Duration period_of(double frames_per_second);

}  // namespace cyclorama::camera
