// SPDX-License-Identifier: Apache-2.0
/// What a scan of the wall needs of the world, besides a turntable (drivers/turntable): something that shows patterns
/// on all projectors, and a camera whose exposure is the scan's choice.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::scan {

/// Projectors count as in installation.toml. While it lives the heads show patterns, dark at first; when it is gone
/// the show comes back as it was. Thread-bound; calls block.
class PatternScreen {
 public:
  virtual ~PatternScreen() = default;

  /// Returns when the wall shows it; the other projectors keep what they show. An empty picture is dark.
  /// kInvalidArgument  no such projector, or a picture of another size than it has.
  /// kUnavailable  a head is away, or the display is.
  virtual Status show(std::size_t projector, const RgbImage& picture) = 0;

 protected:
  PatternScreen() = default;
  PatternScreen(const PatternScreen&) = delete;
  PatternScreen& operator=(const PatternScreen&) = delete;
};

/// Camera codes, 0 to 1.
using ScanPhotograph = Image<float, 3>;

/// Thread-bound; calls block.
class ScanCamera {
 public:
  virtual ~ScanCamera() = default;

  /// The key of its lens in calibration.json.
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] virtual int width_px() const = 0;
  [[nodiscard]] virtual int height_px() const = 0;
  /// A grey camera gives the same in all channels.
  [[nodiscard]] virtual bool has_colour() const = 0;
  /// Between one code and the next, in parts of the largest: of 8 bits, where a camera does not say otherwise.
  [[nodiscard]] virtual double code_step() const { return 1.0 / 255.0; }
  /// What was exposed wholly after the call began. Codes as the sensor has them, divided by the largest.
  /// kInvalidArgument  an exposure that it cannot do.   kTimedOut, kUnavailable  as Camera::next_frame().
  virtual Result<ScanPhotograph> photograph(double exposure_s) = 0;
  /// How long the last photograph was exposed, which photometry takes as exact: cameras have steps and limits. Of one
  /// that does what it is asked to, what was asked.
  [[nodiscard]] virtual double exposed_s(double asked_s) const { return asked_s; }

 protected:
  ScanCamera() = default;
  ScanCamera(const ScanCamera&) = delete;
  ScanCamera& operator=(const ScanCamera&) = delete;
};

}  // namespace cyclorama::scan
