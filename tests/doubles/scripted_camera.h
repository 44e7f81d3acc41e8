// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <mutex>
#include <utility>

#include "drivers/camera/camera.h"

namespace cyclorama {

/// Returns the test's frames one after another without waiting; then every call times out.
class ScriptedCamera final : public camera::Camera {
 public:
  using Step = Result<std::shared_ptr<const camera::CameraFrame>>;
  explicit ScriptedCamera(std::deque<Step> steps, Status start = Done{})
      : steps_(std::move(steps)), start_(std::move(start)) {}

  [[nodiscard]] const std::string& id() const override { return id_; }
  Status start() override { return start_; }
  Result<std::shared_ptr<const camera::CameraFrame>> next_frame(TimePoint deadline) override {
    if (steps_.empty()) {
      SteadyClock().wait_until(deadline);
      return Error(ErrorCode::kTimedOut, "the script has ended");
    }
    Step step = std::move(steps_.front());
    steps_.pop_front();
    return step;
  }
  void stop() override {}

 private:
  std::string id_ = "scripted";
  std::deque<Step> steps_;
  Status start_;
};

}  // namespace cyclorama
