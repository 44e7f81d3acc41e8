// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "appliance/scan/scan_devices.h"
#include "drivers/camera/camera.h"

namespace cyclorama::scan {

/// Adapts a camera of drivers/camera to ScanCamera. Such a camera has a fixed exposure while it is open, so a change of
/// exposure reopens it. This takes about a second and happens a few times in a scan. Thread-bound.
class FrameScanCamera final : public ScanCamera {
 public:
  /// Opens the camera with a given exposure, fixed gain and fixed white balance; in colour if the camera has colour.
  using Opener = std::function<Result<std::unique_ptr<camera::Camera>>(double exposure_s)>;

  /// Takes one photograph to find the picture's size. Borrows `clock`, which must be the clock of the frames' time
  /// stamps. Errors: those of the opener and of photograph().
  static Result<std::unique_ptr<FrameScanCamera>> open(Opener opener, double exposure_s, const Clock& clock);
  ~FrameScanCamera() override;
  FrameScanCamera(const FrameScanCamera&) = delete;
  FrameScanCamera& operator=(const FrameScanCamera&) = delete;

  [[nodiscard]] const std::string& id() const override { return id_; }
  [[nodiscard]] int width_px() const override { return width_px_; }
  [[nodiscard]] int height_px() const override { return height_px_; }
  [[nodiscard]] bool has_colour() const override { return has_colour_; }
  /// See ScanCamera::photograph(). Errors: kUnavailable also if the camera does not keep a fixed exposure, since its
  /// photographs cannot be compared.
  Result<ScanPhotograph> photograph(double exposure_s) override;
  [[nodiscard]] double exposed_s(double) const override { return exposed_s_; }

 private:
  FrameScanCamera(Opener opener, const Clock& clock) : opener_(std::move(opener)), clock_(clock) {}
  Result<std::shared_ptr<const camera::CameraFrame>> next(double exposure_s);

  Opener opener_;
  const Clock& clock_;
  std::unique_ptr<camera::Camera> camera_;
  double exposure_s_ = 0.0;  ///< The exposure that was requested when the camera was opened.
  double exposed_s_ = 0.0;   ///< The exposure that the last frame reported.
  std::string id_;
  int width_px_ = 0;
  int height_px_ = 0;
  bool has_colour_ = false;
};

}  // namespace cyclorama::scan
