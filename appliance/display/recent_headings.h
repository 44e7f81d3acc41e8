// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "appliance/display/frame.h"
#include "appliance/display/newest_value.h"

namespace cyclorama::display {

/// The newest headings, newest first. A value. Never more than these wait to be shown: a heading arrives two or three
/// refreshes ahead, and a tracker sends one or two for each refresh.
struct RecentHeadings {
  std::array<HeadingNow, 16> headings{};
  std::size_t count = 0;
};

/// Passes headings to the presenter. A new heading is never lost: only the oldest waiting headings are dropped. Neither
/// side ever waits. Each side uses one thread at a time.
class HeadingTrack {
 public:
  /// Adds a heading and sets its `order`.
  void put(HeadingNow heading) {
    heading.order = ++order_;
    std::ranges::move_backward(recent_.headings.begin(), recent_.headings.end() - 1, recent_.headings.end());
    recent_.headings.front() = heading;
    recent_.count = std::min(recent_.count + 1, recent_.headings.size());
    newest_.put(recent_);
  }
  /// Presenter's side. Returns false and leaves `*ret_recent` alone if there is nothing new.
  bool take(RecentHeadings* ret_recent) { return newest_.take(ret_recent); }

 private:
  RecentHeadings recent_;
  std::uint64_t order_ = 0;
  NewestValue<RecentHeadings> newest_;
};

}  // namespace cyclorama::display
