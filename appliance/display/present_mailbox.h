// SPDX-License-Identifier: Apache-2.0
/// Everything that passes between the present thread and the other threads. The present thread's side neither blocks
/// nor allocates nor frees: objects that it no longer uses are returned, and other threads free them.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/caption_layer.h"
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

/// One refresh, as reported by the present thread.
struct RefreshEvent {
  output::Presented presented;
  bool is_first_of_frame = false;  ///< The frame described below was not shown before.
  std::uint64_t frame_order = 0;
  std::uint64_t frame_number = 0;
  std::int64_t frame_shutter_ns = 0;
  std::size_t frame_bytes = 0;
  std::uint32_t frame_tiles = 0;
  std::uint32_t frame_decoded = 0;  ///< Number of the frame's tiles that were decoded.
  TimePoint begun_at{};
  TimePoint decoded_at{};
  TimePoint drawing_at{};
  TimePoint drawn_at{};  ///< Time by which all commands were issued; the card may still be executing them.
  std::int64_t heading_shutter_ns = 0;  ///< Shutter time of a heading that this refresh shows first; else 0.
  bool is_past_guard = false;
  double attract_share = 0.0;  ///< 1: only the attract picture is visible.
  double cut_share = 0.0;      ///< Weight of the place that a cut leaves; 0: no cut is being shown.
  bool has_caption = false;    ///< Something is written on the wall.
  bool is_fading_in = false;   ///< The frame is mixed with the one that it refines.
  double heading_rad = 0.0;    ///< Heading that the picture was turned to.
  double turn_rad = 0.0;       ///< Angle by which the picture was turned.
  /// Eye from which the picture was shown, in the Scene frame; zero before the first frame.
  Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();
  double moved_m = 0.0;  ///< Distance by which the picture's eye was moved.
  /// Remaining distance between that eye and the visitor's: the move was too far, or the frame has no depth.
  double missed_m = 0.0;
  // The members below are set while several displays show the tour (synchronised_refresh.h):
  std::optional<std::int64_t> synchronised_refresh;
  ShowAt frame_due;  ///< Due time of the frame that this refresh shows first, or of an earlier one that it passes over.
  ShowAt heading_due;      ///< Due time of the heading that this refresh shows first.
  Duration drawn_ahead{};  ///< Lead of the start of drawing over the synchronised refresh.

  /// Returns the delay since `due` in refreshes; 0 if nothing was scheduled, or this refresh shows nothing new.
  [[nodiscard]] std::int64_t late(const ShowAt& due) const {
    return due.period_ns == 0 || !synchronised_refresh ? 0
                                                       : std::max<std::int64_t>(0, *synchronised_refresh - due.refresh);
  }
};

/// The part of a refresh that concerns one head.
struct HeadRefresh {
  std::size_t head = 0;
  output::HeadShown shown;
  /// Time of the shutter for the frame that is shown, or of the arrival of its first tile; zero: no frame is shown.
  TimePoint picture_at{};
};

/// Passes copies of the present picture to a watcher, only when requested: the watcher puts in an empty picture, the
/// presenter fills it, and the watcher takes it. Each side uses one thread.
template <typename Picture>
class WatchedPicture {
 public:
  /// Watcher's side: puts in the picture that `make` returns, unless an earlier one has not come back yet.
  template <typename Make>
  void want(const Make& make) {
    if (is_out_) return;
    is_out_ = true;
    empty_.put(make());
  }
  /// Watcher's side: returns the filled picture; null if there is none.
  std::unique_ptr<Picture> take() {
    std::unique_ptr<Picture> picture = filled_.take();
    if (picture != nullptr) is_out_ = false;
    return picture;
  }
  /// Presenter's side: returns the empty picture to fill; null if nobody watches.
  std::unique_ptr<Picture> take_empty() { return empty_.take(); }
  [[nodiscard]] bool is_wanted() const { return !empty_.is_empty(); }
  void give(std::unique_ptr<Picture> picture) { filled_.put(std::move(picture)); }
  /// Presenter's side: returns a picture that it could not fill; it is wanted still.
  void put_back(std::unique_ptr<Picture> picture) { empty_.put(std::move(picture)); }

 private:
  AtomicSlot<Picture> empty_;
  AtomicSlot<Picture> filled_;
  bool is_out_ = false;
};

/// Frames that the presenter no longer uses, until another thread frees them. Each side uses one thread.
class RetiredFrames {
 public:
  /// Presenter's side: adds a frame. Precondition: room() > 0.
  void put(std::unique_ptr<DisplayFrame> frame) {
    const auto slot = std::ranges::find_if(slots_, [](const auto& s) { return s.is_empty(); });
    CHECK(slot != slots_.end());
    slot->put(std::move(frame));
  }
  [[nodiscard]] std::size_t room() const {
    return static_cast<std::size_t>(std::ranges::count_if(slots_, [](const auto& slot) { return slot.is_empty(); }));
  }
  /// Other side: frees all frames, and calls `on_unseen(const DisplayFrame&)` for those that were never shown.
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

  WaitingFrames frames;                 ///< In: whole frames. Every input comes from one thread at a time.
  HeadingTrack headings;                ///< In: the visitor's headings.
  NewestValue<ClockReading> clock;      ///< In: reading of the tour's clock.
  std::atomic<bool> is_failing{false};  ///< In: the tour is unreachable, or its frames are dropped.
  PatternMailbox patterns;              ///< In and out: patterns in place of the show.
  HeadMailbox plans;                    ///< In and out: plans of the heads.
  CaptionMailbox captions;              ///< In and out: what is written on the wall.
  RetiredFrames retired;                ///< Out: frames that can be freed.
  EventRing<RefreshEvent, 1024> refreshes;
  EventRing<HeadRefresh, 4096> head_refreshes;
  WatchedPicture<DisplayFrame> panorama;
  std::vector<WatchedPicture<RgbImage>> heads;  ///< Pictures of the heads' sizes.
  /// Out: time when the newest step ended (a head was drawn, a shader was compiled, or a refresh came). On a slow
  /// processor steps take longer; if a driver hangs, no step ends.
  std::atomic<TimePoint> stepped_at{};
  std::atomic<Duration> max_step{Duration::zero()};  ///< Out: duration of the longest step that has ended.
};

}  // namespace cyclorama::display
