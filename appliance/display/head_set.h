// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/head_painter.h"
#include "common/base/clock.h"

namespace cyclorama::display {

using HeadPlans = std::shared_ptr<const std::vector<HeadPlan>>;

/// What all heads draw with, on its way to the presenter and, when another came in its place, back to be freed.
struct HeadSet {
  explicit HeadSet(HeadPlans of) : plans(std::move(of)) {
    uploads.reserve(plans->size());
    for (const HeadPlan& plan : *plans) uploads.emplace_back(plan);
    painters.reserve(plans->size());
  }

  HeadPlans plans;
  std::vector<HeadUpload> uploads;
  std::vector<HeadPainter> painters;  ///< The presenter's; none on the way there and back.
  /// Frames of greater DisplayFrame::order have all parts decoded that these heads show; with others they are not used before
  /// `latest_at`.
  std::uint64_t needs_frames_after = 0;
  TimePoint latest_at{};
};

/// In: heads to draw with from now on, the newest wins. Out: those of before; until they are freed, no others are
/// taken.
struct HeadMailbox {
  AtomicSlot<HeadSet> wanted;
  AtomicSlot<HeadSet> replaced;
};

}  // namespace cyclorama::display
