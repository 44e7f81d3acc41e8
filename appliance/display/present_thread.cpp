// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/present_thread.h"

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

namespace cyclorama {
namespace {
// Less than the service's TimeoutStartSec, so that the reason is told. A processor that draws in software compiles the
// shaders first: 1 s on one that is common, minutes where that is emulated.
constexpr auto kLongestStart = std::chrono::seconds(270);
constexpr Duration kLongestRefresh = std::chrono::seconds(2);
// Less than the service's WatchdogSec, so that the state is told before the process is ended.
constexpr Duration kLongestOpening = std::chrono::seconds(20);
}  // namespace

Result<std::unique_ptr<PresentThread>> PresentThread::start(PresentPlan plan, PresentMailbox* mailbox,
                                                            const Clock* clock) {
  std::unique_ptr<PresentThread> present(new PresentThread(clock));
  present->event_fd_ = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!present->event_fd_.is_open()) return Error::from_errno("making an eventfd");
  std::future<Status> started = present->started_.get_future();
  PresentThread* const self = present.get();
  present->thread_ = std::jthread([self, mailbox, moved = std::move(plan)](const std::stop_token& stop) mutable {
    pthread_setname_np(pthread_self(), "present");
    self->run(std::move(moved), mailbox, stop);
  });
  if (started.wait_for(kLongestStart) != std::future_status::ready)
    return Error(ErrorCode::kTimedOut, "the graphics driver does not start");
  TRY(started.get());
  return present;
}

void PresentThread::run(PresentPlan plan, PresentMailbox* mailbox, const std::stop_token& stop) {
  auto opened = OutputKeeper::open(std::move(plan), mailbox, &clock_);
  if (!opened) return started_.set_value(std::move(opened).error());
  OutputKeeper& keeper = **opened;
  turn_began_at_ = clock_.now();
  tell(keeper.state());
  started_.set_value(Done{});
  while (!stop.stop_requested()) {
    turn_began_at_ = clock_.now();
    if (keeper.refresh()) tell(keeper.state());
    const std::uint64_t one = 1;
    // A full counter wakes as well as one more would.
    [[maybe_unused]] const auto n = ::write(event_fd_.get(), &one, sizeof one);
  }
}

void PresentThread::tell(const OutputState& state) {
  is_lost_ = state.loss.has_value();
  largest_side_px_ = state.largest_side_px;
  state_.put(std::make_unique<OutputState>(state));
}

bool PresentThread::is_alive() const {
  return clock_.now() - turn_began_at_.load() < (is_lost_ ? kLongestOpening : kLongestRefresh);
}

void PresentThread::drain() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto n = ::read(event_fd_.get(), &count, sizeof count);
}

}  // namespace cyclorama
