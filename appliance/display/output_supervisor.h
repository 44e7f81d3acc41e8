// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/display/presenter.h"

namespace cyclorama::display {

/// What is needed to show.
struct PresentPlan {
  /// Called on the thread that shows, which then owns the output and its GL context; again whenever it was lost.
  std::function<Result<std::unique_ptr<output::Output>>()> open_output;
  std::vector<HeadPlan> heads;
  bool may_change = false;  ///< Others may come by PresentMailbox::plans.
  DisplayFrame attract;     ///< Shown until a frame comes, and when frames fail.
  AttractTimes times;
};

/// How the output fares.
struct OutputState {
  std::optional<Error> loss;  ///< Why there is none just now.
  int losses = 0;             ///< Since the start.
  std::string kind;           ///< "headless EGL", and what GL says of itself, of the newest that was opened.
  std::string renderer;
  int max_side_px = 0;  ///< Of a picture that its graphics card takes.
};

/// A presenter on an output that is opened anew whenever it is lost, for ever: the graphics processor was reset, the
/// card is gone, nothing helped. The inside of the present thread.
///
///              an error                  the pause is over
///   showing ─────────────▶ lost, waiting ─────────────────▶ opening ──▶ showing: the frame, the heading and the fade
///                              ▲                               │         of before, or a frame that came meanwhile
///                              └───── an error: pause doubled ─┘
///
/// Pauses grow from 0.1 s to 5 s, and begin anew once an output lasted for 30 s. The presenter keeps what Presenter promises.
/// Borrows the mailbox and the clock. Thread-bound.
class OutputSupervisor {
 public:
  /// The first time an output that cannot be opened is an error: the output's, or Presenter::make()'s.
  static Result<std::unique_ptr<OutputSupervisor>> open(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock);
  OutputSupervisor(const OutputSupervisor&) = delete;
  OutputSupervisor& operator=(const OutputSupervisor&) = delete;

  /// One refresh; or, while there is no output, at most 50 ms of the pause, or one attempt. True when state() changed.
  bool refresh();
  [[nodiscard]] const OutputState& state() const { return state_; }

 private:
  OutputSupervisor(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock);
  Status try_to_open();
  void lose(Error why);

  const PresentPlan plan_;
  PresentMailbox& mailbox_;
  const Clock& clock_;
  OutputState state_;
  std::optional<PresenterState> showing_;  // While nothing is open.
  std::unique_ptr<output::Output> output_;
  std::unique_ptr<Presenter> presenter_;  // After the output: it dies first.
  TimePoint opened_at_{};
  TimePoint try_at_{};
  Duration pause_;
};

}  // namespace cyclorama::display
