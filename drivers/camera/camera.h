// SPDX-License-Identifier: Apache-2.0
/// A source of pictures: a V4L2 device, libcamera, a recording or a simulated room.
///
///            start()                  stop()
///   Closed ──────────▶ Streaming ──────────▶ Closed
///                          │ unplugged, or a driver error
///                          ▼
///                        Failed             next_frame() returns kUnavailable from now on; make a new Camera.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera {

/// A picture and the time at which it was taken. Immutable once shared.
struct CameraFrame {
  GreyImage pixels;
  /// Red, green and blue codes of the same pixels, as the camera delivers them: the colour space and the response curve
  /// of each channel are unknown. Empty unless colour was requested and the camera has it.
  RgbImage colour;
  std::uint64_t sequence = 0;  ///< Number of the picture; a gap shows how many were dropped.
  TimePoint captured_at{};     ///< Start of exposure, CLOCK_MONOTONIC.
  Duration exposure{};         ///< Exposure time; 0 if the camera does not report it or chooses it.
};

/// Interface to a camera of any kind, for the tracker and the calibrator.
class Camera {
 public:
  virtual ~Camera() = default;

  /// Identifier that is stable across reboots and re-plugs into the same port: the port path, or the recording's file
  /// name.
  /// Use it as the key in calibration.json. Thread-safe.
  [[nodiscard]] virtual const std::string& id() const = 0;

  /// Begins delivery at the size and rate given at construction. Thread-bound.
  ///
  /// Errors: kBusy if another process streams from the device; kUnavailable if the device vanished since it was opened.
  virtual Status start() = 0;

  /// Waits for the next frame, at most until `deadline`. Thread-bound; blocks.
  /// Frames are dropped, never queued: a late caller gets the newest.
  ///
  /// Errors: kTimedOut if no frame came before the deadline (the camera is still Streaming); kUnavailable once Failed
  /// (see the diagram).
  virtual Result<std::shared_ptr<const CameraFrame>> next_frame(TimePoint deadline) = 0;

  /// Ends delivery. Safe to call in any state. Thread-bound.
  virtual void stop() = 0;

 protected:
  Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;
};

}  // namespace cyclorama::camera
