// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/clock.h"
#include "common/base/latest_value.h"
#include "drivers/camera/camera.h"

namespace cyclorama::tracker {

/// Keeps one camera open and its newest picture available, on a thread of its own, `capture`. A camera that fails or is
/// absent is opened again after a pause that grows from kFirstPause to kMaxPause. Thread-safe.
class Capture {
 public:
  using MakeCamera = std::function<Result<std::unique_ptr<camera::Camera>>()>;
  using Frames = LatestValue<std::shared_ptr<const camera::CameraFrame>>;
  static constexpr Duration kFirstPause = std::chrono::milliseconds(100);
  static constexpr Duration kMaxPause = std::chrono::seconds(5);
  /// A camera that streams without a picture for this long is opened again.
  static constexpr Duration kFrameTimeout = std::chrono::seconds(3);

  /// `make` is called on the capture thread. `clock` is borrowed.
  Capture(MakeCamera make, const Clock& clock);
  /// Ends the thread; blocks until the camera returns, which takes up to 200 ms with this project's cameras.
  ~Capture();
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  [[nodiscard]] Frames& frames() { return frames_; }
  /// Number of pictures that were replaced before they were taken.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// The camera's fault in one sentence; empty while it delivers pictures.
  [[nodiscard]] std::string problem() const;
  /// The camera's id; empty before the first camera was made.
  [[nodiscard]] std::string camera_id() const;
  /// Time of the thread's last activity. It proves that the thread is not stuck in a driver.
  [[nodiscard]] TimePoint alive_at() const { return alive_at_; }

 private:
  void run(const std::stop_token& stop);
  /// Streams until the camera fails or the thread is stopped.
  Status stream(camera::Camera* camera, const std::stop_token& stop);
  void set_problem(std::string sentence);
  void beat() { alive_at_ = clock_.now(); }

  const MakeCamera make_;
  const Clock& clock_;
  Frames frames_;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<TimePoint> alive_at_;
  mutable std::mutex mutex_;
  std::string problem_ = "the camera is being opened";
  std::string camera_id_;
  LatestValue<Done> never_;  ///< Never gets a value. A pause waits for it, and closing it ends the pause.
  std::jthread thread_;      ///< Last member, since it uses all the others.
};

}  // namespace cyclorama::tracker
