// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/flip_waiter.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace cyclorama::output {

void* FlipWaiter::expect(std::span<const std::uint32_t> crtc_ids, TimePoint deadline) {
  CHECK(!crtc_ids.empty());
  Commit& commit = commits_[next_];
  next_ = (next_ + 1) % commits_.size();
  commit.waiter = this;
  for (const std::uint32_t id : crtc_ids) {
    auto found = std::find_if(crtcs_.begin(), crtcs_.end(), [&](const CrtcState& c) { return c.id == id; });
    if (found == crtcs_.end()) found = crtcs_.insert(crtcs_.end(), CrtcState{id, nullptr, {}, {}});
    CHECK(found->awaited == nullptr);
    found->awaited = &commit;
    found->deadline = deadline;
  }
  return &commit;
}

void FlipWaiter::cancel(void* cookie) {
  for (CrtcState& crtc : crtcs_) {
    if (crtc.awaited == cookie) crtc.awaited = nullptr;
  }
}

void FlipWaiter::cancel_all() {
  for (CrtcState& crtc : crtcs_) crtc.awaited = nullptr;
}

const FlipWaiter::CrtcState* FlipWaiter::find(std::uint32_t crtc_id) const {
  const auto found = std::find_if(crtcs_.begin(), crtcs_.end(), [&](const CrtcState& c) { return c.id == crtc_id; });
  return found == crtcs_.end() ? nullptr : &*found;
}

bool FlipWaiter::is_waiting_for(std::uint32_t crtc_id) const {
  const CrtcState* const crtc = find(crtc_id);
  return crtc != nullptr && crtc->awaited != nullptr;
}

bool FlipWaiter::is_waiting() const {
  return std::any_of(crtcs_.begin(), crtcs_.end(), [](const CrtcState& c) { return c.awaited != nullptr; });
}

bool FlipWaiter::is_overdue() const {
  const TimePoint now = clock_.now();
  return std::any_of(crtcs_.begin(), crtcs_.end(),
                     [&](const CrtcState& c) { return c.awaited != nullptr && c.deadline <= now; });
}

TimePoint FlipWaiter::next_deadline() const {
  CHECK(is_waiting());
  TimePoint earliest = TimePoint::max();
  for (const CrtcState& crtc : crtcs_) {
    if (crtc.awaited != nullptr) earliest = std::min(earliest, crtc.deadline);
  }
  return earliest;
}

void FlipWaiter::on_flip(int, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc_id,
                         void* cookie) {
  const Commit& commit = *static_cast<const Commit*>(cookie);
  FlipWaiter& waiter = *commit.waiter;
  for (CrtcState& crtc : waiter.crtcs_) {
    if (crtc.id != crtc_id || crtc.awaited != &commit) continue;
    crtc.awaited = nullptr;
    const bool has_time = waiter.card_->has_monotonic_time();
    const TimePoint at = has_time ? TimePoint(std::chrono::seconds(seconds) + std::chrono::microseconds(microseconds))
                                  : waiter.clock_.now();
    // The kernel's drm_crtc_send_vblank_event() sends sequence 0 if there is no vertical blank.
    crtc.flipped = Flipped{at, sequence != 0};
  }
}

Status FlipWaiter::take_events(const Card& card, TimePoint until) {
  card_ = &card;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - clock_.now());
    pollfd entry{card.fd(), POLLIN, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return Error::from_errno("waiting for a page flip");
    if (ready == 0) return Done{};
    drmEventContext handlers{};
    handlers.version = 3;
    handlers.page_flip_handler2 = &FlipWaiter::on_flip;
    if (drmHandleEvent(card.fd(), &handlers) == 0) return Done{};
    if (errno != EINTR && errno != EAGAIN)
      return Error::from_errno(fmt::format("reading the events of '{}'", card.path().string()));
  }
}

std::optional<Flipped> FlipWaiter::flipped(std::uint32_t crtc_id) const {
  const CrtcState* const crtc = find(crtc_id);
  return crtc == nullptr ? std::nullopt : crtc->flipped;
}

void FlipWaiter::clear() {
  for (CrtcState& crtc : crtcs_) crtc.flipped.reset();
}

}  // namespace cyclorama::output
