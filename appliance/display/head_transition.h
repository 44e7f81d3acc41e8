// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "appliance/display/head_set.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// The heads' present painters, and the transition from one calibration to the next:
///
///   shown alone ──a new set──▶ its heads given to the card, one per refresh ──▶ its first frame is decoded
///        ▲                                                                               │ (or it takes too long)
///        └──────────── the old set goes back to be freed ◀── half a second of both ◀─────┘
///
/// Thread-bound to the GL context. A change allocates nothing, except shaders that no head has needed before and
/// whatever the driver allocates.
class HeadTransition {
 public:
  /// Borrows the Gl table and the mailbox. Errors: kSystem if the graphics card refuses a resource.
  static Result<std::unique_ptr<HeadTransition>> make(const output::Gl& gl, Texels texels, HeadPlans plans,
                                                      HeadMailbox* mailbox);

  /// Advances by one refresh. `newest_frame` is the DisplayFrame::order of the frame that is shown, or 0 for the
  /// display's own picture. Returns true if the heads must be drawn again. Errors: kSystem if the graphics card refuses
  /// a resource.
  Result<bool> step(TimePoint now, std::uint64_t newest_frame);

  [[nodiscard]] const std::vector<HeadPainter>& painters() const { return now_->painters; }
  /// Draws a head's present picture (see HeadPainter::draw()). Precondition: the head's framebuffer is bound.
  void draw(std::size_t head, const TurnedPicture& shown, const TurnedPicture& attract, double share, Eye eye,
            const ShownCaption* caption = nullptr) const;
  /// Prepares all painters, also later ones, for drawing the caption, which is borrowed; null: there is none. Errors:
  /// kSystem if the driver's compiler refuses a program.
  Status set_caption(const Caption* caption);
  [[nodiscard]] std::size_t count() const { return depths_bits_.size(); }
  [[nodiscard]] int depth_bits(std::size_t head) const { return depths_bits_[head]; }
  void set_depth(std::size_t head, int depth_bits);
  /// Makes the driver compile the programs that the head needs. With `may_change` these include the programs for a
  /// transition between two sets of painters. Precondition: the head's framebuffer is bound.
  void warm_up(std::size_t head, const TurnedPicture& shown, const TurnedPicture& attract, bool may_change,
               const std::function<void()>& stepped) const;
  /// Returns the newest set's plans, for the next presenter.
  [[nodiscard]] HeadPlans newest_plans() const { return (next_ != nullptr ? next_ : now_)->plans; }

 private:
  HeadTransition(const output::Gl& gl, Texels texels, HeadMailbox* mailbox)
      : gl_(gl), programs_(gl), texels_(texels), mailbox_(*mailbox) {}
  Status add_painter(HeadSet* set);
  [[nodiscard]] bool is_ready(TimePoint now, std::uint64_t newest_frame) const;

  const output::Gl& gl_;
  HeadPrograms programs_;
  Texels texels_;
  HeadMailbox& mailbox_;
  std::vector<int> depths_bits_;  // Bits per code value, to which the painters dither.
  std::unique_ptr<HeadSet> now_;
  std::unique_ptr<HeadSet> next_;  // Null except during a transition.
  TimePoint began_at_{};           // Time when the blend began; zero: it has not begun.
  double share_ = 0.0;             // Share of the next set in the blend.
  const Caption* caption_ = nullptr;
};

}  // namespace cyclorama::display
