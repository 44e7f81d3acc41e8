// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/capture.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

namespace cyclorama::tracker {
namespace {
/// Maximum delay until a request to stop is noticed.
constexpr Duration kLookAround = std::chrono::milliseconds(200);
}  // namespace

Capture::Capture(MakeCamera make, const Clock& clock)
    : make_(std::move(make)), clock_(clock), alive_at_(clock.now()), thread_([this](const std::stop_token& stop) {
        pthread_setname_np(pthread_self(), "capture");
        run(stop);
      }) {}

Capture::~Capture() {
  thread_.request_stop();
  never_.close();
  thread_.join();
  frames_.close();
}

std::string Capture::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

std::string Capture::camera_id() const {
  const std::lock_guard lock(mutex_);
  return camera_id_;
}

void Capture::set_problem(std::string sentence) {
  const std::lock_guard lock(mutex_);
  problem_ = std::move(sentence);
}

void Capture::run(const std::stop_token& stop) {
  Duration pause = kFirstPause;
  while (!stop.stop_requested()) {
    beat();
    Status ended = Done{};
    if (auto camera = make_(); !camera) {
      ended = std::move(camera).error();
    } else {
      {
        const std::lock_guard lock(mutex_);
        camera_id_ = (*camera)->id();
      }
      const TimePoint began = clock_.now();
      ended = stream(camera->get(), stop);
      if (clock_.now() - began > kMaxPause) pause = kFirstPause;  // The camera worked for a while.
    }
    if (stop.stop_requested()) return;
    set_problem(ended ? "the camera stopped" : ended.error().message());
    // Uses the real time instead of `clock_`, since this pause limits the load of the machine.
    for (const TimePoint until = SteadyClock().now() + pause; SteadyClock().now() < until && !never_.is_closed();) {
      beat();
      static_cast<void>(never_.take_before(std::min(until, SteadyClock().now() + kLookAround)));
    }
    pause = std::min(2 * pause, kMaxPause);
  }
}

Status Capture::stream(camera::Camera* camera, const std::stop_token& stop) {
  TRY(camera->start());
  TimePoint heard_at = clock_.now();
  while (!stop.stop_requested()) {
    beat();
    auto frame = camera->next_frame(clock_.now() + kLookAround);
    if (frame) {
      heard_at = clock_.now();
      set_problem("");
      if (frames_.put(*std::move(frame))) ++dropped_;
    } else if (frame.error().code() != ErrorCode::kTimedOut) {
      return std::move(frame).error();
    } else if (clock_.now() - heard_at > kFrameTimeout) {
      return Error(ErrorCode::kTimedOut, "the camera streams but sends no pictures");
    }
  }
  camera->stop();
  return Done{};
}

}  // namespace cyclorama::tracker
