// SPDX-License-Identifier: Apache-2.0
/// All that passes between the present thread and the others. The present thread's side of everything here neither
/// blocks nor allocates nor frees: whatever it is done with goes back to be freed by others.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/event_ring.h"
#include "appliance/display/frame.h"
#include "appliance/display/head_set.h"
#include "appliance/display/newest_value.h"
#include "appliance/display/pattern_wall.h"
#include "appliance/display/recent_headings.h"
#include "appliance/display/synchronised_refresh.h"
#include "appliance/display/waiting_frames.h"
#include "common/base/clock_offset.h"

namespace cyclorama::display {

/// One refresh, told to whoever listens.
struct RefreshEvent {
  output::Presented presented;
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
  double heading_rad = 0.0;    ///< That the picture was turned to,
  double turn_rad = 0.0;       ///< and by how much.
  // While several displays show the tour (synchronised_refresh.h):
  std::optional<std::int64_t> synchronised_refresh;
  ShowAt frame_due;        ///< When what is seen here first was to be seen: the frame, or one that it passed over,
  ShowAt heading_due;      ///< the heading.
  Duration drawn_ahead{};  ///< Of the shared refresh.

  /// By how many refreshes; 0 when nothing was said, or nothing is seen first.
  [[nodiscard]] std::int64_t late(const ShowAt& due) const {
    return due.period_ns == 0 || !synchronised_refresh ? 0
                                                       : std::max<std::int64_t>(0, *synchronised_refresh - due.refresh);
  }
};

/// What one head did in a refresh.
struct HeadRefresh {
  std::size_t head = 0;
  output::HeadShown shown;
  TimePoint picture_at{};  ///< Shutter of the frame that is shown, or when its first tile came; zero: no frame is seen.
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
  /// The presenter's. Precondition: room() > 0.
  void put(std::unique_ptr<DisplayFrame> frame) {
    const auto slot = std::ranges::find_if(slots_, [](const auto& s) { return s.is_empty(); });
    CHECK(slot != slots_.end());
    slot->put(std::move(frame));
  }
  [[nodiscard]] std::size_t room() const {
    return static_cast<std::size_t>(std::ranges::count_if(slots_, [](const auto& slot) { return slot.is_empty(); }));
  }
  /// The others': frees all, and tells `on_unseen(const DisplayFrame&)` of those that were never shown.
  template <typename OnUnseen>
  void clear(const OnUnseen& on_unseen) {
    for (auto& slot : slots_) {
      const std::unique_ptr<DisplayFrame> frame = slot.take();
      if (frame != nullptr && !frame->was_shown) on_unseen(*frame);
    }
  }

 private:
  std::array<AtomicSlot<DisplayFrame>, 8> slots_;
};

struct PresentMailbox {
  explicit PresentMailbox(std::size_t head_count) : heads(head_count) {}

  WaitingFrames frames;                 ///< In: whole frames; from one thread at a time, as all that comes in.
  HeadingTrack headings;                ///< In.
  NewestValue<ClockReading> clock;      ///< In: the tour's.
  std::atomic<bool> is_failing{false};  ///< In: the tour is gone, or its frames are given up.
  PatternMailbox patterns;              ///< In and out: what is shown in the show's place.
  HeadMailbox plans;                    ///< In and out: what the heads draw with.
  RetiredFrames retired;                ///< Out.
  EventRing<RefreshEvent, 1024> refreshes;
  EventRing<HeadRefresh, 4096> head_refreshes;
  WatchedPicture<DisplayFrame> panorama;
  std::vector<WatchedPicture<RgbImage>> heads;  ///< Of the heads' sizes.
  /// Out: when the newest step ended: a head was drawn, a shader tried, a refresh waited for. A processor that is slow
  /// takes its steps slowly; a driver that hangs takes none.
  std::atomic<TimePoint> stepped_at{};
  std::atomic<Duration> max_step{Duration::zero()};  ///< Out: of those that ended.
};

}  // namespace cyclorama::display
