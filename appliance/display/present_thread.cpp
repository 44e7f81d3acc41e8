// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/present_thread.h"

#include <pthread.h>
#include <sys/eventfd.h>

#include <utility>

namespace cyclorama {
namespace {
constexpr auto kLongestStart = std::chrono::seconds(30);
}

Result<std::unique_ptr<PresentThread>> PresentThread::start(PresentPlan plan, PresentMailbox* mailbox,
                                                            const Clock* clock) {
  std::unique_ptr<PresentThread> present(new PresentThread);
  present->event_fd_ = UniqueFd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!present->event_fd_.is_open()) return Error::from_errno("making an eventfd");
  present->end_ = present->result_.get_future();
  std::future<Done> started = present->started_.get_future();
  PresentThread* const self = present.get();
  present->thread_ = std::jthread([self, mailbox, clock, moved = std::move(plan)](const std::stop_token& stop) mutable {
    pthread_setname_np(pthread_self(), "present");
    self->result_.set_value(self->run(std::move(moved), mailbox, clock, stop));
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto n = ::write(self->event_fd_.get(), &one, sizeof one);
  });
  const TimePoint deadline = SteadyClock().now() + kLongestStart;
  while (started.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
    TRY(present->state());
    if (SteadyClock().now() > deadline) return Error(ErrorCode::kTimedOut, "the graphics driver does not start");
  }
  return present;
}

Status PresentThread::run(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock, const std::stop_token& stop) {
  TRY_ASSIGN(const std::unique_ptr<Output> output, plan.open_output());
  TRY_ASSIGN(const std::unique_ptr<Presenter> presenter,
             Presenter::make(output.get(), plan.heads, plan.attract, plan.times, mailbox, clock));
  kind_ = output->kind();
  renderer_ = output->gl().renderer();
  GLint largest = 0;
  output->gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  largest_side_px_ = largest;
  plan = {};
  started_.set_value(Done{});
  while (!stop.stop_requested()) {
    TRY(presenter->refresh());
    const std::uint64_t one = 1;
    // A full counter wakes as well as one more would.
    [[maybe_unused]] const auto n = ::write(event_fd_.get(), &one, sizeof one);
  }
  return Done{};
}

void PresentThread::drain() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto n = ::read(event_fd_.get(), &count, sizeof count);
}

Status PresentThread::state() {
  if (end_.valid() && end_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) state_ = end_.get();
  return state_;
}

}  // namespace cyclorama
