// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama {

/// Which of several trackers steers: the one that first saw a tag keeps control until it has lost it for a second.
/// Pure; thread-bound.
class TrackerChoice {
 public:
  static constexpr Duration kKept = std::chrono::seconds(1);

  /// True when what `tracker` saw at `now` steers the visit.
  bool sees_tag(std::uint64_t tracker, TimePoint now) {
    if (holder_ && *holder_ != tracker && now - seen_at_ <= kKept) return false;
    holder_ = tracker;
    seen_at_ = now;
    return true;
  }
  /// Its stream ended: another one may take over at once.
  void leaves(std::uint64_t tracker) {
    if (holder_ == tracker) holder_.reset();
  }

 private:
  std::optional<std::uint64_t> holder_;
  TimePoint seen_at_{};
};

}  // namespace cyclorama
