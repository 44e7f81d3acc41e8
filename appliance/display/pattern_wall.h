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
    std::shared_ptr<const RgbaImage> picture;  ///< Has the head's size; null: the head is dark.
    bool is_awaited = false;                   ///< The client waits until the head shows the picture.
  };
  std::uint64_t order = 0;  ///< A greater value is newer.
  bool is_open = false;     ///< False: the heads show the tour again.
  std::vector<Head> heads;  ///< In the order of the output's heads.
};

/// The newest wall that the presenter took, and the heads that do not show it yet.
struct PatternsShown {
  std::uint64_t order = 0;
  std::uint64_t lacking = 0;  ///< Bit i: head i is awaited and does not show its picture yet (first 64 heads only).
  TimePoint at{};             ///< Time when the last awaited head showed its picture.
};

/// Slots between the client of patterns and the presenter. The presenter's side neither blocks nor allocates nor frees.
struct PatternMailbox {
  AtomicSlot<PatternWall> wanted;    ///< In: a newer wall replaces one that was not taken.
  AtomicSlot<PatternWall> replaced;  ///< Out, to be freed; until then the presenter takes no other.
  NewestValue<PatternsShown> shown;  ///< Out: heads that show their pictures.
};

}  // namespace cyclorama::display
