// SPDX-License-Identifier: Apache-2.0
/// A camera, whatever it is made of: a V4L2 device, libcamera, a recording, or a simulated room.
///
///            start()                  stop()
///   Closed ──────────▶ Streaming ──────────▶ Closed
///                          │ unplugged, or a driver error
///                          ▼
///                        Failed          next_frame() returns kUnavailable for ever; make a new Camera.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera {

/// One picture and when it was taken. Immutable once shared.
struct CameraFrame {
  GreyImage pixels;
  /// The camera's own red, green and blue codes of the same pixels: in no colour space that is known, each channel with
  /// a curve of its own. Empty, unless the camera was asked for colour and has it.
  RgbImage colour;
  std::uint64_t sequence = 0;  ///< Counts the camera's pictures; a gap shows what was dropped.
  TimePoint captured_at{};     ///< Start of exposure, CLOCK_MONOTONIC.
  Duration exposure{};         ///< As the camera made it of what was asked for; 0: it does not tell, or sets its own.
};

/// Read by the tracker and the calibrator; neither knows which camera it holds.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Stable across reboots and re-plugs into the same port (USB path, or the recording's file name).
  /// Use it as the key in calibration.json. Thread-safe.
  [[nodiscard]] virtual const std::string& id() const = 0;

  /// Begins delivery at the size and rate given when it was made. Thread-bound.
  ///
  /// kBusy         another process streams from the device.
  /// kUnavailable  the device vanished since it was opened.
  virtual Status start() = 0;

  /// Waits for the next frame, at most until `deadline`. Thread-bound; blocks.
  /// Frames are dropped, never queued: a late caller gets the newest.
  ///
  /// kTimedOut     no frame before the deadline. The camera is still Streaming.
  /// kUnavailable  Failed; see the diagram.
  virtual Result<std::shared_ptr<const CameraFrame>> next_frame(TimePoint deadline) = 0;

  /// Ends delivery. Safe to call in any state. Thread-bound.
  virtual void stop() = 0;

 protected:
  Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;
};

}  // namespace cyclorama::camera
