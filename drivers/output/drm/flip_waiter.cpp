// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/flip_waiter.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace cyclorama::output {

void* FlipWaiter::expect(std::size_t crtcs) {
  CHECK(current_ == nullptr && crtcs > 0);
  current_ = &commits_[next_];
  next_ = (next_ + 1) % commits_.size();
  done_ = nullptr;
  *current_ = {this, crtcs, {}, {}, 0};
  return current_;
}

void FlipWaiter::cancel() { current_ = nullptr; }

void FlipWaiter::on_flip(int, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc_id,
                         void* cookie) {
  Commit& commit = *static_cast<Commit*>(cookie);
  if (commit.missing > 0) --commit.missing;
  const bool has_time = commit.waiter->card_->has_monotonic_time();
  const TimePoint at = has_time ? TimePoint(std::chrono::seconds(seconds) + std::chrono::microseconds(microseconds))
                                : commit.waiter->clock_.now();
  commit.flipped.at = std::max(commit.flipped.at, at);
  if (commit.crtc_count < commit.crtcs.size()) commit.crtcs[commit.crtc_count++] = {crtc_id, at};
  // The kernel's drm_crtc_send_vblank_event() sends sequence 0 if there is no vertical blank.
  commit.flipped.has_vblank = sequence != 0;
}

Result<Flipped> FlipWaiter::wait(const Card& card, std::chrono::milliseconds timeout) {
  CHECK(current_ != nullptr);
  card_ = &card;
  Commit& commit = *current_;
  current_ = nullptr;
  done_ = nullptr;
  const TimePoint deadline = clock_.now() + timeout;
  while (commit.missing > 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock_.now());
    pollfd entry{card.fd(), POLLIN, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return Error::from_errno("waiting for a page flip");
    if (ready == 0) {
      return Error(ErrorCode::kTimedOut,
                   fmt::format("'{}' did not flip within {} ms", card.path().string(), timeout.count()));
    }
    drmEventContext handlers{};
    handlers.version = 3;
    handlers.page_flip_handler2 = &FlipWaiter::on_flip;
    if (drmHandleEvent(card.fd(), &handlers) != 0) {
      if (errno == EINTR || errno == EAGAIN) continue;
      return Error::from_errno(fmt::format("reading the events of '{}'", card.path().string()));
    }
  }
  done_ = &commit;
  return commit.flipped;
}

std::optional<TimePoint> FlipWaiter::flipped_at(std::uint32_t crtc_id) const {
  if (done_ == nullptr) return std::nullopt;
  for (std::size_t i = 0; i < done_->crtc_count; ++i) {
    if (done_->crtcs[i].id == crtc_id) return done_->crtcs[i].at;
  }
  return std::nullopt;
}

}  // namespace cyclorama::output
