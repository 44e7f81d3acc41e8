// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "appliance/display/frame.h"
#include "appliance/display/newest_value.h"

namespace cyclorama::display {

/// The newest headings, the newest first. A value. More than these never wait to be shown: a heading is told two or
/// three refreshes ahead, and a tracker sends one or two for each.
struct RecentHeadings {
  std::array<HeadingNow, 16> headings{};
  std::size_t count = 0;
};

/// Headings on their way to the presenter. What is put is never lost: only the oldest of those that wait are forgotten.
/// Neither side ever waits. Each side on one thread at a time.
class HeadingTrack {
 public:
  /// `order` is set here.
  void put(HeadingNow heading) {
    heading.order = ++order_;
    std::ranges::move_backward(recent_.headings.begin(), recent_.headings.end() - 1, recent_.headings.end());
    recent_.headings.front() = heading;
    recent_.count = std::min(recent_.count + 1, recent_.headings.size());
    newest_.put(recent_);
  }
  /// The presenter's. False when there is nothing new; `*ret_recent` is then left alone.
  bool take(RecentHeadings* ret_recent) { return newest_.take(ret_recent); }

 private:
  RecentHeadings recent_;
  std::uint64_t order_ = 0;
  NewestValue<RecentHeadings> newest_;
};

}  // namespace cyclorama::display
