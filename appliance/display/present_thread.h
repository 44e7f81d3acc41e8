// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "appliance/display/presenter.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// What the present thread needs to begin.
struct PresentPlan {
  /// Called on the present thread, which then owns the output and its GL context.
  std::function<Result<std::unique_ptr<Output>>()> open_output;
  std::vector<HeadPlan> heads;
  Frame attract;  ///< Shown until a frame comes, and when frames fail.
  AttractTimes times;
};

/// The thread that owns GL and shows. Thread-bound to whoever starts it.
class PresentThread {
 public:
  /// Opens the output and draws nothing yet. Borrows the mailbox and the clock.
  /// Errors of the output and of Presenter::make(); kTimedOut when the driver takes longer than 30 s.
  static Result<std::unique_ptr<PresentThread>> start(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock);
  /// Ends with the refresh that it is in.
  ~PresentThread() = default;

  /// "headless EGL" and what GL says of itself.
  [[nodiscard]] const std::string& output_kind() const { return kind_; }
  [[nodiscard]] const std::string& renderer() const { return renderer_; }
  /// The largest side of a picture that the graphics card takes.
  [[nodiscard]] int largest_side_px() const { return largest_side_px_; }
  /// Readable whenever a refresh was told to the mailbox; for poll(). Reset it with drain().
  [[nodiscard]] int event_fd() const { return event_fd_.get(); }
  void drain() const;
  /// Once the output is lost, why. Then nothing is shown any more.
  [[nodiscard]] Status state();

 private:
  PresentThread() = default;
  Status run(PresentPlan plan, PresentMailbox* mailbox, const Clock* clock, const std::stop_token& stop);

  UniqueFd event_fd_;
  std::string kind_;
  std::string renderer_;
  int largest_side_px_ = 0;
  std::promise<Done> started_;   // Set when the members above are.
  std::promise<Status> result_;  // Set at the end.
  std::future<Status> end_;
  Status state_ = Done{};
  std::jthread thread_;  // Last: it ends before what it uses.
};

}  // namespace cyclorama
