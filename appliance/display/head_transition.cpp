// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_transition.h"

#include <algorithm>

namespace cyclorama::display {
namespace {
constexpr double kBlend_s = 0.5;
}

Result<std::unique_ptr<HeadTransition>> HeadTransition::make(const output::Gl& gl, Texels texels, HeadPlans plans,
                                                             HeadMailbox* mailbox) {
  std::unique_ptr<HeadTransition> change(new HeadTransition(gl, texels, mailbox));
  for (const HeadPlan& plan : *plans) change->depths_bits_.push_back(plan.depth_bits);
  change->now_ = std::make_unique<HeadSet>(std::move(plans));
  while (change->now_->painters.size() < change->now_->uploads.size()) TRY(change->add_painter(change->now_.get()));
  change->now_->uploads = {};
  return change;
}

Status HeadTransition::add_painter(HeadSet* set) {
  const std::size_t head = set->painters.size();
  TRY_ASSIGN(HeadPainter painter, HeadPainter::make(gl_, &programs_, set->uploads[head], texels_));
  painter.set_depth(depths_bits_[head]);
  TRY(painter.set_caption(&programs_, caption_));
  set->painters.push_back(std::move(painter));
  return Done{};
}

Result<bool> HeadTransition::step(TimePoint now, std::uint64_t newest_frame) {
  if (next_ == nullptr) {
    if (!mailbox_.replaced.is_empty()) return false;
    next_ = mailbox_.wanted.take();
    began_at_ = {};
    share_ = 0.0;
    if (next_ == nullptr) return false;
    CHECK(next_->uploads.size() == depths_bits_.size());
  }
  if (next_->painters.size() < next_->uploads.size()) {
    TRY(add_painter(next_.get()));
    return false;
  }
  if (began_at_ == TimePoint{} && !is_ready(now, newest_frame)) return false;
  if (began_at_ == TimePoint{}) began_at_ = now;
  const double progress = std::clamp(to_seconds(now - began_at_) / kBlend_s, 0.0, 1.0);
  share_ = progress * progress * (3.0 - 2.0 * progress);
  if (progress < 1.0) return true;
  std::swap(now_, next_);
  next_->painters.clear();  // Frees their GL objects here, where the context is current.
  mailbox_.replaced.put(std::move(next_));
  return true;
}

bool HeadTransition::is_ready(TimePoint now, std::uint64_t newest_frame) const {
  return newest_frame == 0 || newest_frame > next_->needs_frames_after || now >= next_->latest_at;
}

void HeadTransition::draw(std::size_t head, const TurnedPicture& shown, const TurnedPicture& attract, double share,
                          Eye eye, const ShownCaption* caption) const {
  const HeadPainter& painter = now_->painters[head];
  const bool is_blending = next_ != nullptr && began_at_ != TimePoint{};
  if (is_blending) {
    // Mixes code values instead of light, since the two pictures are nearly the same.
    const auto of_next = static_cast<float>(share_);
    gl_.Enable(GL_BLEND);
    gl_.BlendColor(0.0f, 0.0f, 0.0f, 1.0f - of_next);
    gl_.BlendFunc(GL_CONSTANT_ALPHA, GL_ZERO);
    painter.draw(shown, attract, share, eye, caption);
    gl_.BlendColor(0.0f, 0.0f, 0.0f, of_next);
    gl_.BlendFunc(GL_CONSTANT_ALPHA, GL_ONE);
    next_->painters[head].draw_over(shown, attract, share, eye, caption);
    gl_.Disable(GL_BLEND);
  } else if (share <= 0.0) {
    painter.draw(shown, eye, caption);
  } else if (share >= 1.0) {
    painter.draw(attract, eye, caption);
  } else {
    painter.draw(shown, attract, share, eye, caption);
  }
}

Status HeadTransition::set_caption(const Caption* caption) {
  caption_ = caption;
  for (HeadSet* const set : {now_.get(), next_.get()}) {
    if (set == nullptr) continue;
    for (HeadPainter& painter : set->painters) TRY(painter.set_caption(&programs_, caption));
  }
  return Done{};
}

void HeadTransition::warm_up(std::size_t head, const TurnedPicture& shown, const TurnedPicture& attract,
                             bool may_change, const std::function<void()>& stepped) const {
  now_->painters[head].warm_up(shown, attract, stepped);
  if (!may_change) return;
  gl_.Enable(GL_BLEND);
  for (const GLenum old : {GLenum{GL_ZERO}, GLenum{GL_ONE}}) {
    gl_.BlendFunc(GL_CONSTANT_ALPHA, old);
    now_->painters[head].warm_up(shown, attract, stepped);
  }
  gl_.Disable(GL_BLEND);
}

void HeadTransition::set_depth(std::size_t head, int depth_bits) {
  depths_bits_[head] = depth_bits;
  for (HeadSet* const set : {now_.get(), next_.get()}) {
    if (set != nullptr && head < set->painters.size()) set->painters[head].set_depth(depth_bits);
  }
}

}  // namespace cyclorama::display
