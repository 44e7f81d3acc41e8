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

/// What the heads show in the show's place while the wall is measured: everything, not a change to it. A value; its
/// pictures are shared and never change.
struct PatternWall {
  struct Head {
    std::shared_ptr<const RgbaImage> picture;  ///< Of the head's size; null: dark.
    bool is_awaited = false;                   ///< Whoever put this waits for the head to show it.
  };
  std::uint64_t order = 0;  ///< A greater one is newer.
  bool is_open = false;     ///< False: the show is back.
  std::vector<Head> heads;  ///< The output's, in order.
};

/// How far the heads are with the newest wall that the presenter took.
struct PatternsShown {
  std::uint64_t order = 0;
  std::uint64_t lacking = 0;  ///< Bit i: head i is awaited and does not show it yet (the first 64).
  TimePoint at{};             ///< When the last of them had it.
};

/// Between whoever orders patterns and the presenter, whose side neither blocks nor allocates nor frees.
struct PatternMailbox {
  AtomicSlot<PatternWall> wanted;    ///< In: the newest wins.
  AtomicSlot<PatternWall> replaced;  ///< Out, to be freed; until then no other is taken.
  NewestValue<PatternsShown> shown;  ///< Out.
};

}  // namespace cyclorama::display
