// SPDX-License-Identifier: Apache-2.0
/// The messages that wait for one display: the newest heading, and frames in order, in bounded memory.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "common/wire/museum.pb.h"

namespace cyclorama::tour {

using SharedShowMessage = std::shared_ptr<const wire::ShowMessage>;

/// A slow display loses whole frames, and nothing waits for it. Frames are offered in the farm's order: begin, tiles,
/// end.
///
/// 1. A frame is sent as its begin, all its tiles and its end, or as the first of these messages and an end with
///    `complete` false.
/// 2. At most the rest of one frame that is being sent, and the newest frame, wait.
/// 3. A heading overtakes tiles and replaces an unsent older heading. The first message of a stream is a heading. So
///    does a caption, which waits only for headings.
/// 4. A display that joins in the middle of a frame starts with the next one.
///
/// Thread-bound; its owner locks.
class Outbox {
 public:
  /// `shown` is sent with the first heading. `max_bytes` is the upper bound of the waiting tiles.
  explicit Outbox(wire::Panorama shown, std::size_t max_bytes = std::size_t{96} << 20);

  /// `show_at` is null to show the heading at once.
  void put_heading(const wire::Heading& heading, const wire::ShowAt* show_at = nullptr);
  /// Queues a caption. It replaces an unsent older one. Precondition: the message has a caption.
  void put_caption(const SharedShowMessage& caption) { caption_ = caption; }
  /// Queues an answer ahead of everything else; it replaces an answer that still waits.
  void put_answer(const wire::ClockReply& answer) { answer_ = answer; }
  /// Queues a begin, tile or end. Returns the number of the frame that this display loses as a result, if it loses one.
  std::optional<std::uint64_t> put(const SharedShowMessage& message);
  /// Returns the waiting answer; the caller must send it at once, so that its times are right.
  std::optional<wire::ClockReply> take_answer() { return std::exchange(answer_, std::nullopt); }
  /// Returns the next message other than the answer, or null; null before the first heading.
  SharedShowMessage take();

  [[nodiscard]] std::size_t waiting_bytes() const { return bytes_; }

 private:
  std::optional<std::uint64_t> drop_unstarted_frame();
  std::optional<std::uint64_t> give_up_frame();
  void push(const SharedShowMessage& message);
  void pop_back();

  const std::size_t max_bytes_;
  std::optional<wire::Panorama> shown_;  ///< Set until the first heading is sent.
  std::optional<wire::ShowMessage> heading_;
  std::optional<wire::ClockReply> answer_;
  SharedShowMessage caption_;  ///< Null: none waits.
  std::deque<SharedShowMessage> frames_;
  std::size_t bytes_ = 0;
  std::optional<std::uint64_t> accepting_;  ///< Frame that the farm is sending, if this display takes it.
};

}  // namespace cyclorama::tour
