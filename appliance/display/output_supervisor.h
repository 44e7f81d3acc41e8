// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/display/presenter.h"

namespace cyclorama::display {

/// Everything that a presenter needs.
struct PresentPlan {
  /// Called on the present thread, which then owns the output and its GL context; called again whenever the output was
  /// lost.
  std::function<Result<std::unique_ptr<output::Output>>()> open_output;
  std::vector<HeadPlan> heads;
  bool may_change = false;  ///< Other plans may come through PresentMailbox::plans.
  DisplayFrame attract;     ///< Shown until a frame comes, and when frames fail.
  AttractTimes times;
};

/// State of the output.
struct OutputState {
  std::optional<Error> loss;  ///< Set while there is no output.
  int losses = 0;             ///< Number of losses since the start.
  /// Kind of the output that was opened last, such as "headless EGL", and the renderer that GL reports for it.
  std::string kind;
  std::string renderer;
  int max_side_px = 0;  ///< Maximum side of a picture on the output's graphics card.
};

/// Runs a presenter on an output, and reopens the output whenever it is lost (after a reset of the graphics processor,
/// or when a card disappears), for as long as that takes. Runs on the present thread.
///
///              an error                  the pause is over
///   showing ─────────────▶ lost, waiting ─────────────────▶ opening ──▶ showing: the former frame, heading and fade,
///                              ▲                               │         or a frame that came meanwhile
///                              └───── an error: pause doubled ─┘
///
/// Pauses grow from 0.1 s to 5 s, and start over once an output has lasted for 30 s. Keeps Presenter's guarantees about
/// allocation and locks while an output is open. Borrows the mailbox and the clock. Thread-bound.
class OutputSupervisor {
 public:
  /// Opens the output for the first time; a failure is returned, not retried. Errors: those of the output, or of
  /// Presenter::make().
  static Result<std::unique_ptr<OutputSupervisor>> open(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock);
  OutputSupervisor(const OutputSupervisor&) = delete;
  OutputSupervisor& operator=(const OutputSupervisor&) = delete;

  /// Does one refresh. While there is no output, it waits for at most 50 ms, or tries to open one if the pause since
  /// the last attempt is over. Returns true if state() changed.
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
  std::optional<PresenterState> showing_;  // Set while no output is open.
  std::unique_ptr<output::Output> output_;
  std::unique_ptr<Presenter> presenter_;  // Declared after the output, so that it is destroyed first.
  TimePoint opened_at_{};
  TimePoint try_at_{};
  Duration pause_;
};

}  // namespace cyclorama::display
