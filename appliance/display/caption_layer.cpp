// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/caption_layer.h"

#include <algorithm>
#include <utility>

namespace cyclorama::display {

CaptionLayer::CaptionLayer(const output::Gl& gl, HeadTransition* heads, CaptionMailbox* mailbox)
    : gl_(gl), heads_(*heads), mailbox_(*mailbox), texture_(gl) {}

Result<bool> CaptionLayer::step(TimePoint now) {
  if (next_ == nullptr) next_ = mailbox_.wanted.take();
  const Duration since = std::clamp<Duration>(now - stepped_at_, Duration::zero(), kFadeOut / 2);
  stepped_at_ = now;
  const double before = shown_.share;
  if (next_ != nullptr && shown_.share == 0.0) {
    if (mailbox_.replaced.is_empty()) TRY(begin_next());
  } else if (next_ != nullptr) {
    shown_.share = std::max(0.0, shown_.share - to_seconds(since) / to_seconds(kFadeOut));
  } else if (is_written()) {
    shown_.share = std::min(1.0, shown_.share + to_seconds(since) / to_seconds(kFadeIn));
  }
  return shown_.share != before;
}

Status CaptionLayer::begin_next() {
  std::unique_ptr<Caption> old = std::exchange(now_, std::move(next_));
  if (is_written()) upload();
  const Status prepared = heads_.set_caption(is_written() ? now_.get() : nullptr);
  if (old != nullptr) mailbox_.replaced.put(std::move(old));
  return prepared;
}

void CaptionLayer::upload() {
  const GreyImage& ink = now_->ink;
  gl_.ActiveTexture(GL_TEXTURE0 + HeadProgram::kCaption);
  gl_.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (ink.width() > texture_width_ || ink.height() > texture_height_) {
    texture_width_ = std::max(texture_width_, ink.width());
    texture_height_ = std::max(texture_height_, ink.height());
    for (const int filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(filter), GL_LINEAR);
    for (const int wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl_.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(wrap), GL_CLAMP_TO_EDGE);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, texture_width_, texture_height_, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
  }
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, ink.width(), ink.height(), GL_RED, GL_UNSIGNED_BYTE, ink.data().data());
  shown_.texture = texture_.id();
  shown_.width_px = ink.width();
  shown_.height_px = ink.height();
  shown_.texture_width_px = texture_width_;
  shown_.texture_height_px = texture_height_;
}

std::unique_ptr<Caption> CaptionLayer::take() {
  // The heads borrow the caption that is shown, but nothing is drawn any more.
  return std::move(next_ != nullptr ? next_ : now_);
}

}  // namespace cyclorama::display
