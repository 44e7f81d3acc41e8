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

/// What the heads began to show at a moment, until the next one. A value; what it points to never changes.
struct ShownSince {
  std::uint64_t number = 0;  ///< Counted from 1.
  TimePoint at{};
  std::shared_ptr<const DisplayFrame> frame;  ///< Null: it is no show, but patterns, a fade, or a change of the heads.
  double turn_rad = 0.0;
  HeadPlans plans;
};

/// What the heads showed of late, told by the refreshes after they happened: nothing here is known to the present
/// thread. Keeps the picture that is shown, which is there anyway; and what was shown in the last two seconds as long
/// as somebody asks. Thread-safe.
class ShownHistory {
 public:
  static constexpr Duration kKept = std::chrono::seconds(2);
  static constexpr Duration kRequestedWithin = std::chrono::seconds(5);

  ShownHistory(DisplayFrame attract, HeadPlans plans);

  /// A frame went to the presenter.
  void frame_ready(const DisplayFrame& frame);
  /// `plans` went to the presenter; `was_passed_over`: those before them were not taken up.
  void heads_wanted(HeadPlans plans, bool was_passed_over);
  /// The presenter draws with the next of them.
  void heads_changed();
  /// In the order in which they happened. `is_show`: no patterns stand on the wall.
  void refreshed(const RefreshEvent& event, bool is_show);

  struct Shown {
    std::vector<ShownSince> moments;  ///< The last one before `from`, if it is known, and all until `until`.
    TimePoint known_until{};
  };
  /// Somebody asks.
  [[nodiscard]] Shown between(TimePoint from, TimePoint until, TimePoint now);

 private:
  std::mutex mutex_;  ///< Guards all.
  std::shared_ptr<const DisplayFrame> attract_;
  std::deque<std::shared_ptr<const DisplayFrame>> ready_;  ///< The one that is shown, and those to come.
  std::shared_ptr<const DisplayFrame> shown_;              ///< Null before the first.
  HeadPlans plans_;
  std::deque<HeadPlans> coming_;
  std::deque<ShownSince> moments_;
  TimePoint known_until_{};
  TimePoint asked_at_{};
  std::uint64_t number_ = 0;
};

}  // namespace cyclorama::display
