// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/display/pattern_painter.h"
#include "appliance/display/pattern_wall.h"

namespace cyclorama::display {

/// The presenter's part of showing patterns. At each refresh:
///
///   take() ──▶ is_open()? ──▶ for each head that needs_drawing(): draw() ──▶ present ──▶ presented()
///
/// A head is drawn again until a refresh shows it, since a head that was dark, or whose flip failed, shows it later
/// than the others. Thread-bound to the GL context. After the first pattern of each head it allocates and frees
/// nothing.
class PatternShow {
 public:
  /// Borrows the Gl table and the mailbox. Errors: those of PatternPainter::make().
  static Result<std::unique_ptr<PatternShow>> make(const output::Gl& gl, const std::vector<output::HeadMode>& heads,
                                                   PatternMailbox* mailbox);

  /// Takes a newer PatternWall, if there is one. Returns true if patterns have just given way to the show.
  bool take();
  [[nodiscard]] bool is_open() const { return wall_ != nullptr && wall_->is_open; }
  [[nodiscard]] bool needs_drawing(std::size_t head) const { return heads_[head].is_pending; }
  /// Draws into the bound framebuffer, which belongs to that head.
  void draw(std::size_t head);
  /// Records after present() which heads showed their pattern.
  void presented(const output::Presented& presented, const std::vector<output::HeadShown>& shown);

  /// Moves the PatternWall out of a presenter whose output was lost, for the next presenter.
  [[nodiscard]] std::unique_ptr<PatternWall> take_wall() { return std::move(wall_); }
  void go_on_with(std::unique_ptr<PatternWall> wall);

 private:
  PatternShow(const output::Gl& gl, PatternPainter painter, std::size_t head_count, PatternMailbox* mailbox)
      : gl_(gl), painter_(std::move(painter)), mailbox_(*mailbox), heads_(head_count) {}
  struct Head {
    bool is_uploaded = false;  // The head's picture is on the card.
    bool is_pending = false;   // No refresh has shown the picture yet.
    bool is_drawn = false;     // The picture was drawn, and the next refresh may show it.
  };
  const output::Gl& gl_;
  PatternPainter painter_;
  PatternMailbox& mailbox_;
  std::vector<Head> heads_;
  std::unique_ptr<PatternWall> wall_;  // Null before the first wall.
  std::uint64_t answered_ = 0;         // PatternWall::order of the newest wall that all awaited heads showed.
  TimePoint last_at_{};                // Time when the last head of the present wall showed its picture.
};

}  // namespace cyclorama::display
