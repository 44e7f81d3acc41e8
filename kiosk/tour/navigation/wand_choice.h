// SPDX-License-Identifier: Apache-2.0
/// Chooses, among several trackers, the one that steers, and decides which of its pictures count. Pure values.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama::tour {

/// Chooses which of several trackers steers: the one that first saw a tag keeps control until it has not seen one for a
/// second. A tracker chooses between several wands in front of its camera by the same rule. A wand takes precedence
/// over a body: a visitor with a wand takes control from one without, and keeps it.
class WandSelector {
 public:
  static constexpr Duration kKept = std::chrono::seconds(1);

  /// Returns true when what `tracker` saw at `now` steers the visit.
  bool sees_tag(std::uint64_t tracker, TimePoint now, bool body = false) {
    const bool held = holder_ && *holder_ != tracker && now - seen_at_ <= kKept;
    if (held && (body || !by_body_)) return false;
    holder_ = tracker;
    by_body_ = body;
    seen_at_ = now;
    return true;
  }
  /// Ends the tracker's stream: another one may take over at once.
  void leaves(std::uint64_t tracker) {
    if (holder_ == tracker) holder_.reset();
  }

 private:
  std::optional<std::uint64_t> holder_;
  TimePoint seen_at_{};
  bool by_body_ = false;
};

/// Decides which pictures of one tracker are new. A picture may arrive twice or late. After the
/// tracker's clock jumps back, all its pictures look old; they are rejected only for a limited time:
///
///   the same picture again       rejected
///   older than the newest        rejected, unless none was accepted for kReorderTimeout: the order then restarts
class PoseOrder {
 public:
  static constexpr Duration kReorderTimeout = std::chrono::milliseconds(200);

  bool is_news(std::uint64_t sequence, std::int64_t shutter_ns, TimePoint arrived_at) {
    const bool again = heard_ && sequence == sequence_ && shutter_ns == shutter_ns_;
    if (again || (heard_ && shutter_ns < shutter_ns_ && arrived_at - accepted_at_ < kReorderTimeout)) return false;
    heard_ = true;
    sequence_ = sequence;
    shutter_ns_ = shutter_ns;
    accepted_at_ = arrived_at;
    return true;
  }

 private:
  bool heard_ = false;
  std::uint64_t sequence_ = 0;
  std::int64_t shutter_ns_ = 0;
  TimePoint accepted_at_{};
};

}  // namespace cyclorama::tour
