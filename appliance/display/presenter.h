// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "appliance/display/attract_fade.h"
#include "appliance/display/caption_layer.h"
#include "appliance/display/eye_move.h"
#include "appliance/display/frame_light.h"
#include "appliance/display/head_read_back.h"
#include "appliance/display/head_transition.h"
#include "appliance/display/pattern_show.h"
#include "appliance/display/present_mailbox.h"
#include "appliance/display/synchronised_refresh.h"
#include "appliance/display/yaw_shift.h"
#include "drivers/output/output.h"

namespace cyclorama::display {

/// Everything that is shown. It does not depend on the output, so it survives the loss of an output.
struct PresenterState {
  std::unique_ptr<DisplayFrame> frame;                   ///< Null before the first frame.
  std::array<std::unique_ptr<DisplayFrame>, 8> waiting;  ///< Frames that are not due yet, in any order.
  HeadingNow heading;                                    ///< HeadingNow::order is 0 before the first heading.
  RecentHeadings headings;
  AttractFade fade;
  std::unique_ptr<PatternWall> patterns;  ///< Null before the first patterns.
  std::unique_ptr<Caption> caption{};     ///< Null before the first caption.
  HeadPlans plans;                        ///< Plans that the heads draw with, or will draw with next.
};

/// Draws the heads and shows them; runs on the present thread. A frame of another place fades in over the place that
/// was left, which stays as it was; headings of a place turn only its frames. On heads where the two eyes alternate,
/// refreshes with an even number, as all displays of a tour count them (synchronised_refresh.h), show the left eye.
/// Thread-bound to the output's GL context. After warm-up (the first frames of the largest size, and the first cut) it
/// allocates and frees nothing, takes no lock, writes no log and opens nothing, apart from what the graphics driver
/// does inside.
class Presenter {
 public:
  /// Shows `attract` until a frame comes, and when frames fail. `plans` are for the output's heads, in order;
  /// `may_change`: other plans may come later (PresentMailbox::plans). Borrows the output, the mailbox and the clock.
  /// Errors: kSystem if the graphics card refuses a resource.
  static Result<std::unique_ptr<Presenter>> make(output::Output* output, HeadPlans plans, bool may_change,
                                                 const DisplayFrame& attract, const AttractTimes& times,
                                                 PresentMailbox* mailbox, const Clock* clock);
  /// Returns unfinished pictures of heads to the mailbox, for the next presenter.
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;
  static Result<std::unique_ptr<Presenter>> make(output::Output* output, const std::vector<HeadPlan>& plans,
                                                 const DisplayFrame& attract, const AttractTimes& times,
                                                 PresentMailbox* mailbox, const Clock* clock) {
    return make(output, std::make_shared<std::vector<HeadPlan>>(plans), false, attract, times, mailbox, clock);
  }

  /// Resumes what another presenter showed. Errors: kSystem if the graphics card refuses the frame.
  Status go_on_with(PresenterState showing);
  /// Moves the state out for the next presenter. Afterwards this presenter may only be destroyed.
  [[nodiscard]] PresenterState take_state() {
    return {std::move(frame_), std::move(waiting_),   heading_, headings_, fade_, patterns_->take_wall(),
            captions_->take(), heads_->newest_plans()};
  }

  /// Waits for a refresh and shows the newest due frame for the newest due heading (synchronised_refresh.h). Errors:
  /// those of the output, which is then lost.
  Status refresh();

 private:
  Presenter(output::Output* output, PictureProgram program, const AttractTimes& times, PresentMailbox* mailbox,
            const Clock* clock);
  Status warm_up(bool may_change);
  void step();
  void take_in();
  Status show_due_frame(RefreshEvent* ret_event);
  Status leave_place();
  void turn_to_due_heading(RefreshEvent* ret_event);
  Status move_to_due_eye(RefreshEvent* ret_event);
  Status fade_in(RefreshEvent* ret_event);
  Status draw_heads();
  Status draw_patterns();
  void show_watcher(std::size_t head);
  void report_heads();
  void notice_depths();
  void answer_watchers();
  [[nodiscard]] bool is_any_head_watched() const;

  output::Output& output_;
  PresentMailbox& mailbox_;
  const Clock& clock_;
  PictureProgram picture_program_;
  PanoramaTexture attract_;
  PanoramaTexture left_;             // The last frame of the place that a cut has left.
  std::optional<FrameLight> light_;  // Always set after make().
  std::unique_ptr<HeadTransition> heads_;
  std::optional<CaptionLayer> captions_;  // Always set after make().
  std::unique_ptr<PatternShow> patterns_;
  std::vector<HeadReadBack> read_backs_;
  AttractFade fade_;
  std::optional<AttractFade> cut_;  // From left_ to the present place, while that lasts.
  double left_turn_rad_ = 0.0;
  DisplayFrame attract_frame_;
  std::unique_ptr<DisplayFrame> frame_;  // Null before the first frame.
  // All frames that one refresh passes over, and the frame that it replaces, fit into RetiredFrames.
  decltype(PresenterState::waiting) waiting_;
  std::uint64_t newest_taken_ = 0;
  HeadingNow heading_;  // HeadingNow::order is 0 before the first heading.
  RecentHeadings headings_;
  SynchronisedRefresh shared_;
  YawShift shift_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();  // Move of the eye with which light_ is drawn.
  TimePoint fade_began_{};                           // Time of the refresh that took frame_.
  double drawn_share_ = -1.0;
  bool is_drawn_ = false;     // The heads show the present picture.
  bool takes_turns_ = false;  // A head alternates the eyes' pictures at each refresh.
};

}  // namespace cyclorama::display
