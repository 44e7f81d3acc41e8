// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/present_thread.h"

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace cyclorama::display {
namespace {
// Less than the service's WatchdogSec, so that the state is reported before the process is killed. On a busy, emulated
// processor with a software renderer, single steps of 20 to 50 s were observed; is_alive() tolerates them, since
// earlier steps were slow too.
constexpr Duration kMaxStep = std::chrono::seconds(20);
constexpr int kSlower = 4;
constexpr Duration kMaxTimeout = std::chrono::minutes(5);
constexpr auto kReportEvery = std::chrono::seconds(1);
}  // namespace

Result<std::unique_ptr<PresentThread>> PresentThread::start(PresentPlan plan, PresentMailbox* mailbox,
                                                            const Clock* clock, const std::function<void()>& on_step) {
  std::unique_ptr<PresentThread> present(new PresentThread(mailbox, clock));
  present->event_fd_ = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!present->event_fd_.is_open()) return Error::from_errno("making an eventfd");
  mailbox->stepped_at = clock->now();
  std::future<Status> started = present->started_.get_future();
  PresentThread* const self = present.get();
  present->thread_ = std::jthread([self, mailbox, moved = std::move(plan)](const std::stop_token& stop) mutable {
    pthread_setname_np(pthread_self(), "present");
    self->run(std::move(moved), mailbox, stop);
  });
  // There is no timeout here: a thread that hangs in its driver can only be ended with its process, which is the
  // service manager's task.
  TimePoint told = mailbox->stepped_at;
  while (started.wait_for(kReportEvery) != std::future_status::ready) {
    const TimePoint stepped = mailbox->stepped_at;
    if (stepped == told) continue;
    told = stepped;
    if (on_step) on_step();
  }
  TRY(started.get());
  return present;
}

void PresentThread::run(PresentPlan plan, PresentMailbox* mailbox, const std::stop_token& stop) {
  auto opened = OutputSupervisor::open(std::move(plan), mailbox, &clock_);
  if (!opened) return started_.set_value(std::move(opened).error());
  OutputSupervisor& supervisor = **opened;
  tell(supervisor.state());
  started_.set_value(Done{});
  while (!stop.stop_requested()) {
    if (supervisor.refresh()) tell(supervisor.state());
    const std::uint64_t one = 1;
    // If the counter is full, the write fails, but the descriptor is readable anyway.
    [[maybe_unused]] const auto n = ::write(event_fd_.get(), &one, sizeof one);
  }
}

void PresentThread::tell(const OutputState& state) {
  max_side_px_ = state.max_side_px;
  state_.put(std::make_unique<OutputState>(state));
}

bool PresentThread::is_alive() const {
  const Duration timeout = std::clamp(kSlower * mailbox_.max_step.load(), kMaxStep, kMaxTimeout);
  return clock_.now() - mailbox_.stepped_at.load() < timeout;
}

void PresentThread::drain() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto n = ::read(event_fd_.get(), &count, sizeof count);
}

}  // namespace cyclorama::display
