// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/head_painter.h"
#include "common/base/clock.h"

namespace cyclorama::display {

using HeadPlans = std::shared_ptr<const std::vector<HeadPlan>>;

/// Plans and painters of all heads, on the way to the presenter and, once replaced, back to be freed.
struct HeadSet {
  explicit HeadSet(HeadPlans of) : plans(std::move(of)) {
    uploads.reserve(plans->size());
    for (const HeadPlan& plan : *plans) uploads.emplace_back(plan);
    painters.reserve(plans->size());
  }

  HeadPlans plans;
  std::vector<HeadUpload> uploads;
  std::vector<HeadPainter> painters;  ///< Made by the presenter; empty on the way there and back.
  /// Frames with a greater DisplayFrame::order have all parts decoded that these heads show. With older frames the set
  /// is not used before `latest_at`.
  std::uint64_t needs_frames_after = 0;
  TimePoint latest_at{};
};

/// `wanted` goes in: heads to draw with from now on, the newest wins. `replaced` comes out: the former ones; until they
/// are freed, no others are taken.
struct HeadMailbox {
  AtomicSlot<HeadSet> wanted;
  AtomicSlot<HeadSet> replaced;
};

}  // namespace cyclorama::display
