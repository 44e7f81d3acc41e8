// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/output_supervisor.h"

#include <algorithm>
#include <utility>

namespace cyclorama::display {
namespace {
constexpr Duration kFirstPause = std::chrono::milliseconds(100);
constexpr Duration kMaxPause = std::chrono::seconds(5);
constexpr Duration kLasting = std::chrono::seconds(30);
constexpr Duration kTurn = std::chrono::milliseconds(50);
}  // namespace

OutputSupervisor::OutputSupervisor(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock)
    : plan_(std::move(plan)), mailbox_(*mailbox), clock_(*clock), pause_(kFirstPause) {}

Result<std::unique_ptr<OutputSupervisor>> OutputSupervisor::open(PresentPlan plan, PresentMailbox* mailbox,
                                                                 const Clock* clock) {
  std::unique_ptr<OutputSupervisor> supervisor(new OutputSupervisor(std::move(plan), mailbox, clock));
  TRY(supervisor->try_to_open());
  return supervisor;
}

Status OutputSupervisor::try_to_open() {
  TRY_ASSIGN(output_, plan_.open_output());
  mailbox_.stepped_at = clock_.now();
  HeadPlans plans = showing_ ? showing_->plans : std::make_shared<const std::vector<HeadPlan>>(plan_.heads);
  TRY_ASSIGN(presenter_, Presenter::make(output_.get(), std::move(plans), plan_.may_change, plan_.attract, plan_.times,
                                         &mailbox_, &clock_));
  if (showing_) {
    PresenterState before = *std::move(showing_);
    showing_.reset();
    TRY(presenter_->go_on_with(std::move(before)));
  }
  state_.kind = output_->kind();
  state_.renderer = output_->gl().renderer();
  GLint largest = 0;
  output_->gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  state_.max_side_px = largest;
  state_.loss.reset();
  opened_at_ = clock_.now();
  return Done{};
}

bool OutputSupervisor::refresh() {
  if (!state_.loss) {
    auto refreshed = presenter_->refresh();
    if (refreshed) return false;
    ++state_.losses;
    if (clock_.now() - opened_at_ >= kLasting) pause_ = kFirstPause;
    lose(std::move(refreshed).error());
    return true;
  }
  if (const TimePoint now = clock_.now(); now < try_at_) {
    clock_.wait_until(std::min(try_at_, now + kTurn));
    mailbox_.stepped_at = clock_.now();
    return false;
  }
  if (auto opened = try_to_open(); !opened) lose(std::move(opened).error());
  return true;
}

void OutputSupervisor::lose(Error why) {
  if (presenter_ != nullptr) showing_ = presenter_->take_state();
  presenter_.reset();
  output_.reset();
  state_.loss = std::move(why);
  try_at_ = clock_.now() + pause_;
  pause_ = std::min(2 * pause_, kMaxPause);
}

}  // namespace cyclorama::display
