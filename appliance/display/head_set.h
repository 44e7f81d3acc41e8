// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/head_painter.h"
#include "common/base/clock.h"

namespace cyclorama::display {

using HeadPlans = std::shared_ptr<const std::vector<HeadPlan>>;

/// Plans and painters of all heads. They are passed to the presenter and, once replaced, passed back to be freed.
struct HeadSet {
  explicit HeadSet(HeadPlans of) : plans(std::move(of)) {
    uploads.reserve(plans->size());
    for (const HeadPlan& plan : *plans) uploads.emplace_back(plan);
    painters.reserve(plans->size());
  }

  HeadPlans plans;
  std::vector<HeadUpload> uploads;
  std::vector<HeadPainter> painters;  ///< Made and destroyed by the presenter; empty elsewhere.
  /// Frames with a greater DisplayFrame::order have all parts decoded that these heads show. While an older frame is
  /// shown, the set is not used before `latest_at`.
  std::uint64_t needs_frames_after = 0;
  TimePoint latest_at{};
};

/// Passes heads to the presenter (`wanted`: the heads to draw with from now on; a newer set replaces one that was not
/// taken) and back from it (`replaced`: the former heads; until they are freed, the presenter takes no others).
struct HeadMailbox {
  AtomicSlot<HeadSet> wanted;
  AtomicSlot<HeadSet> replaced;
};

}  // namespace cyclorama::display
