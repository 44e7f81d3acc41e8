// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/event_ring.h"
#include "appliance/display/frame.h"
#include "appliance/display/head_painter.h"
#include "appliance/display/yaw_shift.h"
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
  TimePoint begun_at{};
  TimePoint decoded_at{};
  TimePoint drawing_at{};
  std::int64_t heading_shutter_ns = 0;  ///< Of a heading that this refresh shows first; else 0.
  bool is_past_guard = false;
};

/// A picture of what is shown, made only while somebody watches. The watcher raises `is_wanted` and takes the picture;
/// the presenter makes the next when the slot is empty.
template <typename Picture>
struct WatchedPicture {
  std::atomic<bool> is_wanted{false};
  AtomicSlot<Picture> newest;
  [[nodiscard]] bool is_due() const { return is_wanted.load(std::memory_order_relaxed) && newest.is_empty(); }
};

/// All that passes between the present thread and the others; nothing in it blocks. Thread-safe.
struct PresentMailbox {
  explicit PresentMailbox(std::size_t head_count) : heads(head_count) {}

  AtomicSlot<Frame> frame;         ///< In: the newest whole frame.
  AtomicSlot<HeadingNow> heading;  ///< In: the newest heading.
  EventRing<RefreshEvent, 1024> refreshes;
  WatchedPicture<std::shared_ptr<const RgbImage>> panorama;
  std::vector<WatchedPicture<RgbImage>> heads;
};

/// What one projector needs: where its pixels lie and how bright they may be.
struct HeadWarp {
  WarpMesh mesh;
  MaskImage mask;
};

/// Draws and shows: the inside of the present thread. Thread-bound to the output's GL context. Between warm-up (the
/// first frame of a size) and the end it takes no lock, writes no log and opens nothing; it frees a frame's few bytes,
/// and, while a head is watched, allocates that head's picture.
class Presenter {
 public:
  /// Shows `first` until a frame comes. `warps` are the output's heads', in order; `shown_span_rad` is what the whole
  /// wall shows. Borrows the output, the mailbox and the clock. kSystem  the graphics card refused something.
  static Result<std::unique_ptr<Presenter>> make(Output* output, const std::vector<HeadWarp>& warps, const Frame& first,
                                                 double shown_span_rad, PresentMailbox* mailbox, const Clock* clock);

  /// Waits for a refresh and shows the newest frame for the newest heading. Errors of Output: it is lost.
  Status refresh();

 private:
  Presenter(Output* output, WarpProgram program, double shown_span_rad, PresentMailbox* mailbox, const Clock* clock);
  Status take_news(RefreshEvent* ret_event);
  Status draw_heads();
  void read_back(std::size_t head);
  [[nodiscard]] bool is_any_head_due() const;

  Output& output_;
  PresentMailbox& mailbox_;
  const Clock& clock_;
  const double shown_span_rad_;
  WarpProgram program_;
  PanoramaTexture panorama_;
  std::vector<HeadPainter> painters_;
  RgbaImage read_back_;
  Frame frame_;
  HeadingNow heading_;
  bool has_heading_ = false;
  YawShift shift_;
  bool is_drawn_ = false;  // What the heads show is what they should.
};

}  // namespace cyclorama
