// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/pattern_show.h"

#include <algorithm>

namespace cyclorama::display {

Result<std::unique_ptr<PatternShow>> PatternShow::make(const output::Gl& gl, const std::vector<output::HeadMode>& heads,
                                                       PatternMailbox* mailbox) {
  TRY_ASSIGN(PatternPainter painter, PatternPainter::make(gl, heads));
  return std::unique_ptr<PatternShow>(new PatternShow(gl, std::move(painter), heads.size(), mailbox));
}

bool PatternShow::take() {
  if (!mailbox_.replaced.is_empty()) return false;
  std::unique_ptr<PatternWall> next = mailbox_.wanted.take();
  if (next == nullptr) return false;
  CHECK(next->heads.size() == heads_.size());
  const bool was_open = is_open();
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    const bool is_same = was_open && next->heads[i].picture == wall_->heads[i].picture;
    heads_[i].is_uploaded = heads_[i].is_uploaded && is_same;
    heads_[i].is_pending = heads_[i].is_pending || !is_same || next->heads[i].is_awaited;
  }
  last_at_ = {};
  std::swap(wall_, next);
  if (next != nullptr) mailbox_.replaced.put(std::move(next));
  return was_open && !is_open();
}

void PatternShow::draw(std::size_t head) {
  Head& to = heads_[head];
  to.is_drawn = true;
  const std::shared_ptr<const RgbaImage>& picture = wall_->heads[head].picture;
  if (picture == nullptr) {
    gl_.ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    gl_.Clear(GL_COLOR_BUFFER_BIT);
    return;
  }
  if (!to.is_uploaded) painter_.upload(head, *picture);
  to.is_uploaded = true;
  painter_.draw(head);
}

void PatternShow::presented(const output::Presented& presented, const std::vector<output::HeadShown>& shown) {
  if (wall_ == nullptr) return;
  PatternsShown told{wall_->order, 0, presented.at};
  for (std::size_t i = 0; i < heads_.size(); ++i) {
    Head& head = heads_[i];
    if (head.is_drawn && shown[i].light == output::HeadShown::Light::kNew) {
      head.is_pending = false;
      last_at_ = std::max(last_at_, shown[i].at);
    }
    head.is_drawn = false;
    if (is_open() && wall_->heads[i].is_awaited && head.is_pending && i < 64) told.lacking |= std::uint64_t{1} << i;
  }
  if (answered_ == wall_->order) return;
  if (told.lacking == 0) answered_ = wall_->order;
  if (last_at_ != TimePoint{}) told.at = last_at_;
  mailbox_.shown.put(told);
}

void PatternShow::go_on_with(std::unique_ptr<PatternWall> wall) {
  wall_ = std::move(wall);
  for (Head& head : heads_) head = {false, true, false};
}

}  // namespace cyclorama::display
