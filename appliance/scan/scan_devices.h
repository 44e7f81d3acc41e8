// SPDX-License-Identifier: Apache-2.0
/// The devices that a scan of the wall needs besides a turntable (drivers/turntable): a screen that shows patterns on
/// all projectors, and a camera whose exposure the scan chooses.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::scan {

/// Shows patterns on the projectors, which are numbered as in installation.toml. While this object exists the heads
/// show patterns, dark at first; its destruction restores the show. Thread-bound; calls block.
class PatternScreen {
 public:
  virtual ~PatternScreen() = default;

  /// Shows a picture, and returns when the wall shows it; the other projectors' pictures stay. An empty picture is
  /// dark. Errors: kInvalidArgument if there is no such projector or the picture's size differs from the projector's;
  /// kUnavailable if a head or the display is gone.
  virtual Status show(std::size_t projector, const RgbImage& picture) = 0;

 protected:
  PatternScreen() = default;
  PatternScreen(const PatternScreen&) = delete;
  PatternScreen& operator=(const PatternScreen&) = delete;
};

/// Photograph in camera codes, divided by the largest code.
using ScanPhotograph = Image<float, 3>;

/// The camera of a scan. Thread-bound; calls block.
class ScanCamera {
 public:
  virtual ~ScanCamera() = default;

  /// Returns the camera's id, which is the key of its lens in calibration.json.
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] virtual int width_px() const = 0;
  [[nodiscard]] virtual int height_px() const = 0;
  /// False for a grey camera, whose photographs have the same values in all channels.
  [[nodiscard]] virtual bool has_colour() const = 0;
  /// Returns the step between adjacent camera codes as a fraction of the largest code; the default is that of 8 bits.
  [[nodiscard]] virtual double code_step() const { return 1.0 / 255.0; }
  /// Takes a photograph that was exposed entirely after the call began. Values are the sensor's codes divided by the
  /// largest code. Errors: kInvalidArgument if the camera cannot use this exposure; kTimedOut and kUnavailable are
  /// those of Camera::next_frame().
  virtual Result<ScanPhotograph> photograph(double exposure_s) = 0;
  /// Returns the actual exposure of the last photograph, which photometry uses, since cameras have steps and limits.
  /// The default returns the requested exposure.
  [[nodiscard]] virtual double exposed_s(double asked_s) const { return asked_s; }

 protected:
  ScanCamera() = default;
  ScanCamera(const ScanCamera&) = delete;
  ScanCamera& operator=(const ScanCamera&) = delete;
};

}  // namespace cyclorama::scan
