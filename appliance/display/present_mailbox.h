// SPDX-License-Identifier: Apache-2.0
/// All that passes between the present thread and the others. The present thread's side of everything here neither
/// blocks nor allocates nor frees: whatever it is done with goes back to be freed by others.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/event_ring.h"
#include "appliance/display/frame.h"
#include "appliance/display/newest_value.h"
#include "drivers/output/output.h"

namespace cyclorama {

/// One refresh, told to whoever listens.
struct RefreshEvent {
  Presented presented;
  bool is_first_of_frame = false;  ///< The frame below was never shown before.
  std::uint64_t frame_order = 0;
  std::uint64_t frame_number = 0;
  std::int64_t frame_shutter_ns = 0;
  std::size_t frame_bytes = 0;
  std::uint32_t frame_tiles = 0;
  std::uint32_t frame_decoded = 0;  ///< Of them.
  TimePoint begun_at{};
  TimePoint decoded_at{};
  TimePoint drawing_at{};
  TimePoint drawn_at{};                 ///< The commands were given; the card may still be at it.
  std::int64_t heading_shutter_ns = 0;  ///< Of a heading that this refresh shows first; else 0.
  bool is_past_guard = false;
  double attract_share = 0.0;  ///< 1: nothing but the attract picture is seen.
};

/// A picture of what is shown, made only while somebody watches: the watcher lays an empty one out, the presenter fills
/// it, the watcher takes it. Each side on one thread.
template <typename Picture>
class WatchedPicture {
 public:
  /// The watcher's: lays `make()` out, unless one is out already.
  template <typename Make>
  void want(const Make& make) {
    if (is_out_) return;
    is_out_ = true;
    empty_.put(make());
  }
  /// The watcher's: null when none is filled.
  std::unique_ptr<Picture> take() {
    std::unique_ptr<Picture> picture = filled_.take();
    if (picture != nullptr) is_out_ = false;
    return picture;
  }
  /// The presenter's: null when nobody watches.
  std::unique_ptr<Picture> take_empty() { return empty_.take(); }
  [[nodiscard]] bool is_wanted() const { return !empty_.is_empty(); }
  void give(std::unique_ptr<Picture> picture) { filled_.put(std::move(picture)); }

 private:
  AtomicSlot<Picture> empty_;
  AtomicSlot<Picture> filled_;
  bool is_out_ = false;
};

/// Frames that the presenter is done with, until somebody frees them. Each side on one thread.
class RetiredFrames {
 public:
  /// The presenter's. Precondition: has_room().
  void put(std::unique_ptr<Frame> frame) {
    const auto slot = std::ranges::find_if(slots_, [](const auto& s) { return s.is_empty(); });
    CHECK(slot != slots_.end());
    slot->put(std::move(frame));
  }
  [[nodiscard]] bool has_room() const {
    return std::ranges::any_of(slots_, [](const auto& slot) { return slot.is_empty(); });
  }
  /// The others': frees all.
  void clear() {
    for (auto& slot : slots_) slot.take();
  }

 private:
  std::array<AtomicSlot<Frame>, 8> slots_;
};

struct PresentMailbox {
  explicit PresentMailbox(std::size_t head_count) : heads(head_count) {}

  AtomicSlot<Frame> frame;              ///< In: the newest whole frame.
  NewestValue<HeadingNow> heading;      ///< In: the newest heading; from one thread at a time.
  std::atomic<bool> is_failing{false};  ///< In: the tour is gone, or its frames are given up.
  RetiredFrames retired;                ///< Out.
  EventRing<RefreshEvent, 1024> refreshes;
  WatchedPicture<Frame> panorama;
  std::vector<WatchedPicture<RgbImage>> heads;  ///< Of the heads' sizes.
};

}  // namespace cyclorama
