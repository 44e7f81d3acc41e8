// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "appliance/display/attract_fade.h"
#include "appliance/display/head_transition.h"
#include "appliance/display/pattern_show.h"
#include "appliance/display/present_mailbox.h"
#include "appliance/display/synchronised_refresh.h"
#include "appliance/display/yaw_shift.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// What is shown, apart from where: it outlives an output that is lost.
struct PresenterState {
  std::unique_ptr<DisplayFrame> frame;                   ///< Null before the first.
  std::array<std::unique_ptr<DisplayFrame>, 8> waiting;  ///< Not due yet, in any order.
  HeadingNow heading;                                    ///< Its order is 0 before the first.
  RecentHeadings headings;
  AttractFade fade;
  std::unique_ptr<PatternWall> patterns;  ///< Null before the first.
  HeadPlans plans;                        ///< What the heads draw with, or are about to.
};

/// Draws and shows: the inside of the present thread. On heads where two eyes take turns it is the left one's at
/// refreshes of an even number, as all displays of a tour count them (synchronised_refresh.h). Thread-bound to the output's
/// GL context. After warm-up (the first frames of the largest size) it allocates and frees nothing, takes no lock,
/// writes no log and opens nothing; what the graphics driver does inside is the driver's.
class Presenter {
 public:
  /// Shows `attract` until a frame comes, and when frames fail. `plans` are the output's heads', in order;
  /// `may_change`: others may come later (PresentMailbox::plans). Borrows the output, the mailbox and the clock.
  /// kSystem  the graphics card refused something.
  static Result<std::unique_ptr<Presenter>> make(output::Output* output, HeadPlans plans, bool may_change,
                                                 const DisplayFrame& attract, const AttractTimes& times,
                                                 PresentMailbox* mailbox, const Clock* clock);
  static Result<std::unique_ptr<Presenter>> make(output::Output* output, const std::vector<HeadPlan>& plans,
                                                 const DisplayFrame& attract, const AttractTimes& times,
                                                 PresentMailbox* mailbox, const Clock* clock) {
    return make(output, std::make_shared<std::vector<HeadPlan>>(plans), false, attract, times, mailbox, clock);
  }

  /// Goes on with what another one showed. kSystem  the graphics card refused the frame.
  Status go_on_with(PresenterState showing);
  /// For the next one. Afterwards this one may only die.
  [[nodiscard]] PresenterState take_state() {
    return {std::move(frame_),      std::move(waiting_),   heading_, headings_, fade_,
            patterns_->take_wall(), heads_->newest_plans()};
  }

  /// Waits for a refresh and shows the newest frame for the newest heading, of those that are due (synchronised_refresh.h).
  /// Errors of Output: it is lost.
  Status refresh();

 private:
  Presenter(output::Output* output, PictureProgram program, const AttractTimes& times, PresentMailbox* mailbox,
            const Clock* clock);
  Status warm_up(bool may_change);
  void step();
  void take_in();
  Status show_due_frame(RefreshEvent* ret_event);
  void turn_to_due_heading(RefreshEvent* ret_event);
  Status draw_heads();
  Status draw_patterns();
  void show_watcher(std::size_t head);
  void report_heads();
  void notice_depths();
  void read_back(std::size_t head, RgbImage* ret_picture);
  [[nodiscard]] bool is_any_head_watched() const;

  output::Output& output_;
  PresentMailbox& mailbox_;
  const Clock& clock_;
  PictureProgram picture_program_;
  PanoramaTexture attract_;
  PanoramaTexture panorama_;
  std::unique_ptr<HeadTransition> heads_;
  std::unique_ptr<PatternShow> patterns_;
  std::vector<RgbaImage> read_backs_;
  AttractFade fade_;
  DisplayFrame attract_frame_;
  std::unique_ptr<DisplayFrame> frame_;  // Null before the first.
  // Those that one refresh passes over and the one that it replaces find room among the retired.
  decltype(PresenterState::waiting) waiting_;
  std::uint64_t newest_taken_ = 0;
  HeadingNow heading_;  // Its order is 0 before the first.
  RecentHeadings headings_;
  SynchronisedRefresh shared_;
  YawShift shift_;
  double drawn_share_ = -1.0;
  bool is_drawn_ = false;     // What the heads show is what they should.
  bool takes_turns_ = false;  // A head shows another eye's picture at each refresh.
};

}  // namespace cyclorama::display
