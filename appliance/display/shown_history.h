// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "appliance/display/frame.h"
#include "appliance/display/head_set.h"

namespace cyclorama::display {

struct RefreshEvent;

/// The picture of the heads from one moment until the next. A value; the objects that it points to never change.
struct ShownSince {
  std::uint64_t number = 0;  ///< Counted from 1.
  TimePoint at{};
  /// Null: the heads do not show one frame, but patterns, a fade, a moved eye, or a transition to other heads.
  std::shared_ptr<const DisplayFrame> frame;
  double turn_rad = 0.0;
  HeadPlans plans;
};

/// The recent pictures of the heads, derived from refreshes after they happened; the present thread is not involved.
/// Keeps the picture that is shown, which is in memory anyway, and the pictures of the last two seconds as long as
/// clients request them. Thread-safe.
class ShownHistory {
 public:
  static constexpr Duration kKept = std::chrono::seconds(2);
  static constexpr Duration kRequestedWithin = std::chrono::seconds(5);

  ShownHistory(DisplayFrame attract, HeadPlans plans);

  /// Records that a frame went to the presenter.
  void frame_ready(const DisplayFrame& frame);
  /// Records that `plans` went to the presenter. `was_passed_over`: the plans before them were never used.
  void heads_wanted(HeadPlans plans, bool was_passed_over);
  /// Records that the presenter draws with the next plans.
  void heads_changed();
  /// Records refreshes, in the order in which they happened. `is_show`: the wall shows no patterns.
  void refreshed(const RefreshEvent& event, bool is_show);

  struct Shown {
    std::vector<ShownSince> moments;  ///< The last moment before `from`, if it is known, and all moments until `until`.
    TimePoint known_until{};
  };
  /// Returns the moments between two times, and notes that a client requested them at `now`.
  [[nodiscard]] Shown between(TimePoint from, TimePoint until, TimePoint now);

 private:
  std::mutex mutex_;  ///< Guards all members.
  std::shared_ptr<const DisplayFrame> attract_;
  std::deque<std::shared_ptr<const DisplayFrame>> ready_;  ///< The frame that is shown, and the next ones.
  std::shared_ptr<const DisplayFrame> shown_;              ///< Null before the first frame.
  HeadPlans plans_;
  std::deque<HeadPlans> coming_;
  std::deque<ShownSince> moments_;
  TimePoint known_until_{};
  TimePoint asked_at_{};
  std::uint64_t number_ = 0;
};

}  // namespace cyclorama::display
