// SPDX-License-Identifier: Apache-2.0
/// Of several trackers, whose pictures count, and which of them steers. Pure values.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama {

/// Which of several trackers steers: the one that first saw a tag keeps control until it has lost it for a second.
/// Several wands before one camera are the tracker's to sort out, by the same rule. A wand goes before a body: who
/// holds one takes control from who stands there without, and keeps it.
class WandChoice {
 public:
  static constexpr Duration kKept = std::chrono::seconds(1);

  /// True when what `tracker` saw at `now` steers the visit.
  bool sees_tag(std::uint64_t tracker, TimePoint now, bool body = false) {
    const bool held = holder_ && *holder_ != tracker && now - seen_at_ <= kKept;
    if (held && (body || !by_body_)) return false;
    holder_ = tracker;
    by_body_ = body;
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
  bool by_body_ = false;
};

/// Which pictures of one tracker are news. A picture may come twice or late; and a tracker's clock may jump, after
/// which all its pictures look old. They are, but not for ever:
///
///   the same picture again       no news
///   older than the newest        no news, until none was accepted for kPatience: then time starts anew with it
class PictureOrder {
 public:
  static constexpr Duration kPatience = std::chrono::milliseconds(200);

  bool is_news(std::uint64_t sequence, std::int64_t shutter_ns, TimePoint arrived_at) {
    const bool again = heard_ && sequence == sequence_ && shutter_ns == shutter_ns_;
    if (again || (heard_ && shutter_ns < shutter_ns_ && arrived_at - accepted_at_ < kPatience)) return false;
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

}  // namespace cyclorama
