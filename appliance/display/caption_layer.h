// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/caption.h"
#include "appliance/display/head_transition.h"

namespace cyclorama::display {

/// Passes captions to the presenter (a newer one replaces one that was not taken), and back from it to be freed; until
/// that is done, the presenter takes no other.
struct CaptionMailbox {
  AtomicSlot<Caption> wanted;
  AtomicSlot<Caption> replaced;
};

/// The caption on the wall. One caption fades out before the next fades in, since nobody reads a mixture
/// of two. Thread-bound to the GL context; borrows the Gl table, the heads and the mailbox. It allocates nothing, apart
/// from the first caption's program and the driver's memory for the largest.
class CaptionLayer {
 public:
  static constexpr Duration kFadeOut = std::chrono::milliseconds(150);
  static constexpr Duration kFadeIn = std::chrono::milliseconds(300);

  CaptionLayer(const output::Gl& gl, HeadTransition* heads, CaptionMailbox* mailbox);

  /// Advances by one refresh. Returns true if the heads must be drawn again. Errors: kSystem if the graphics card refuses
  /// the program.
  Result<bool> step(TimePoint now);
  /// Null: nothing is written.
  [[nodiscard]] const ShownCaption* shown() const { return shown_.share > 0.0 ? &shown_ : nullptr; }
  /// Resumes what another presenter showed.
  void go_on_with(std::unique_ptr<Caption> caption) { next_ = std::move(caption); }
  /// Returns the newest caption, for the next presenter; null if there was none.
  [[nodiscard]] std::unique_ptr<Caption> take();

 private:
  [[nodiscard]] bool is_written() const { return now_ != nullptr && !now_->ink.empty(); }
  Status begin_next();
  void upload();

  const output::Gl& gl_;
  HeadTransition& heads_;
  CaptionMailbox& mailbox_;
  output::GlTexture texture_;
  int texture_width_ = 0;
  int texture_height_ = 0;
  std::unique_ptr<Caption> now_;
  std::unique_ptr<Caption> next_;
  TimePoint stepped_at_{};
  ShownCaption shown_;
};

}  // namespace cyclorama::display
