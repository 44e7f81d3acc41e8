// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/outbox.h"

#include <algorithm>
#include <utility>

#include "common/wire/payload.h"

namespace cyclorama::tour {
namespace {

std::size_t bytes_of(const wire::ShowMessage& message) {
  return message.has_tile() ? payload_bytes(message.tile()) : 0;
}

}  // namespace

Outbox::Outbox(wire::Panorama shown, std::size_t max_bytes) : max_bytes_(max_bytes), shown_(std::move(shown)) {}

void Outbox::put_heading(const wire::Heading& heading, const wire::ShowAt* show_at) {
  heading_.emplace();
  *heading_->mutable_heading() = heading;
  if (show_at != nullptr) *heading_->mutable_show_at() = *show_at;
}

std::optional<std::uint64_t> Outbox::put(const SharedShowMessage& message) {
  if (message->has_begin()) {
    const auto dropped = drop_unstarted_frame();
    accepting_ = message->begin().number();
    push(message);
    return dropped;
  }
  if (!accepting_) return std::nullopt;  // The display joined in the middle of this frame, or gave it up.
  if (bytes_ + bytes_of(*message) > max_bytes_) return give_up_frame();
  push(message);
  if (message->has_end()) accepting_.reset();
  return std::nullopt;
}

SharedShowMessage Outbox::take() {
  if (heading_) {
    auto message = std::make_shared<wire::ShowMessage>(*std::exchange(heading_, std::nullopt));
    if (shown_) *message->mutable_heading()->mutable_shown() = *std::exchange(shown_, std::nullopt);
    return message;
  }
  if (shown_) return nullptr;
  if (caption_ != nullptr) return std::exchange(caption_, nullptr);
  if (frames_.empty()) return nullptr;
  SharedShowMessage message = std::move(frames_.front());
  frames_.pop_front();
  bytes_ -= bytes_of(*message);
  return message;
}

std::optional<std::uint64_t> Outbox::drop_unstarted_frame() {
  const auto begin = std::find_if(frames_.begin(), frames_.end(), [](const auto& m) { return m->has_begin(); });
  if (begin == frames_.end()) return std::nullopt;
  const std::uint64_t number = (*begin)->begin().number();
  for (auto left = frames_.end() - begin; left > 0; --left) pop_back();
  return number;
}

std::optional<std::uint64_t> Outbox::give_up_frame() {
  const std::optional<std::uint64_t> number = std::exchange(accepting_, std::nullopt);
  if (drop_unstarted_frame()) return number;
  // The frame's begin was sent: the messages that still wait are removed, and the frame is ended, so that the display
  // does not wait for the rest.
  while (!frames_.empty() && frames_.back()->has_tile() && frames_.back()->tile().view_number() == number) pop_back();
  auto message = std::make_shared<wire::ShowMessage>();
  message->mutable_end()->set_view_number(*number);
  message->mutable_end()->set_complete(false);
  message->mutable_end()->set_reason("the display is too slow for frames of this size");
  push(message);
  return number;
}

void Outbox::push(const SharedShowMessage& message) {
  bytes_ += bytes_of(*message);
  frames_.push_back(message);
}

void Outbox::pop_back() {
  bytes_ -= bytes_of(*frames_.back());
  frames_.pop_back();
}

}  // namespace cyclorama::tour
