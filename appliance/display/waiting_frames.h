// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/frame.h"

namespace cyclorama::display {

/// Whole frames on their way to the presenter, unordered; DisplayFrame::order gives their order. Neither side ever
/// waits. Each side uses one thread at a time.
class WaitingFrames {
 public:
  /// Adds `frame`. Returns the oldest waiting frame if there is no room for all, else null.
  std::unique_ptr<DisplayFrame> put(std::unique_ptr<DisplayFrame> frame) {
    std::unique_ptr<DisplayFrame> untaken = slots_[next_].put(std::move(frame));
    next_ = (next_ + 1) % slots_.size();
    return untaken;
  }
  /// Presenter's side: takes any frame; null if there is none.
  std::unique_ptr<DisplayFrame> take() {
    for (auto& slot : slots_) {
      if (!slot.is_empty()) return slot.take();
    }
    return nullptr;
  }

 private:
  std::array<AtomicSlot<DisplayFrame>, 4> slots_;
  std::size_t next_ = 0;
};

}  // namespace cyclorama::display
