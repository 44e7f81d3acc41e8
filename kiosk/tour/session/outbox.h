// SPDX-License-Identifier: Apache-2.0
/// What waits to be sent to one display: the newest heading, and frames in order, never more than a bounded heap.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "common/wire/museum.pb.h"

namespace cyclorama {

using SharedShowMessage = std::shared_ptr<const wire::ShowMessage>;

/// A slow display loses whole frames and nobody waits for it. Frames are offered in the farm's order: begin, tiles,
/// end.
///
/// 1. What is sent of a frame is its begin, then all tiles and its end, or an end with `complete` false.
/// 2. At most the rest of one frame that is being sent, and the newest frame, wait.
/// 3. A heading overtakes tiles; an unsent older heading is forgotten. The first message ever is a heading.
/// 4. A display that joins in the middle of a frame starts with the next one.
///
/// Thread-bound: its owner locks.
class Outbox {
 public:
  /// `shown` goes with the first heading. `most_bytes` of tiles may wait.
  explicit Outbox(wire::Panorama shown, std::size_t most_bytes = std::size_t{96} << 20);

  /// `show_at`: null for at once.
  void put_heading(double heading_rad, std::int64_t shutter_ns, const wire::ShowAt* show_at = nullptr);
  /// Goes before everything else; one that waits still is forgotten.
  void put_answer(const wire::ClockAnswer& answer) { answer_ = answer; }
  /// One of begin, tile or end. Returns the number of the frame that this display loses by it, if it loses one.
  std::optional<std::uint64_t> put(const SharedShowMessage& message);
  /// The answer that waits, to be sent now, so that its times are right.
  std::optional<wire::ClockAnswer> take_answer() { return std::exchange(answer_, std::nullopt); }
  /// The next message to send but for the answer, or null. Nothing before the first heading.
  SharedShowMessage take();

  [[nodiscard]] std::size_t waiting_bytes() const { return bytes_; }

 private:
  std::optional<std::uint64_t> drop_unstarted_frame();
  std::optional<std::uint64_t> give_up_frame();
  void push(const SharedShowMessage& message);
  void pop_back();

  const std::size_t most_bytes_;
  std::optional<wire::Panorama> shown_;  ///< Until the first heading is sent.
  std::optional<wire::ShowMessage> heading_;
  std::optional<wire::ClockAnswer> answer_;
  std::deque<SharedShowMessage> frames_;
  std::size_t bytes_ = 0;
  std::optional<std::uint64_t> accepting_;  ///< The frame that the farm sends now, if it is wanted here.
};

}  // namespace cyclorama
