// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/newest_value.h"
#include "common/base/clock.h"
#include "common/image/image.h"

namespace cyclorama::display {

/// The patterns of all heads while the wall is measured: a complete state, not a change to the former one. A value; its
/// pictures are shared and never change.
struct PatternWall {
  struct Head {
    std::shared_ptr<const RgbaImage> picture;  ///< Has the head's size; null: dark.
    bool is_awaited = false;                   ///< The client waits until the head shows it.
  };
  std::uint64_t order = 0;  ///< A greater value is newer.
  bool is_open = false;     ///< False: the heads show the tour again.
  std::vector<Head> heads;  ///< The output's heads, in order.
};

/// The newest wall that the presenter took, and the heads that do not show it yet.
struct PatternsShown {
  std::uint64_t order = 0;
  std::uint64_t lacking = 0;  ///< Bit i: head i is awaited and does not show it yet (the first 64).
  TimePoint at{};             ///< Time when the last awaited head showed it.
};

/// Slots between the client of patterns and the presenter, whose side neither blocks nor allocates nor frees.
struct PatternMailbox {
  AtomicSlot<PatternWall> wanted;    ///< In: the newest wins.
  AtomicSlot<PatternWall> replaced;  ///< Out, to be freed; until then the presenter takes no other.
  NewestValue<PatternsShown> shown;  ///< Out.
};

}  // namespace cyclorama::display
