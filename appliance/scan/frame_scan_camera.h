// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "appliance/scan/scan_devices.h"
#include "drivers/camera/camera.h"

namespace cyclorama::scan {

/// A camera of drivers/camera as the scan wants one. These take their exposure when they are opened, so another
/// exposure is another opening: about a second, a few times in a scan. Thread-bound.
class FrameScanCamera final : public ScanCamera {
 public:
  /// Opens the camera with this exposure, its gain and white balance held; with its colours, if it has any.
  using Opener = std::function<Result<std::unique_ptr<camera::Camera>>(double exposure_s)>;

  /// Takes one photograph, to know its size. `clock` is that of the frames, and borrowed. Errors as the opener's and
  /// photograph()'s.
  static Result<std::unique_ptr<FrameScanCamera>> open(Opener opener, double exposure_s, const Clock& clock);
  ~FrameScanCamera() override;
  FrameScanCamera(const FrameScanCamera&) = delete;
  FrameScanCamera& operator=(const FrameScanCamera&) = delete;

  [[nodiscard]] const std::string& id() const override { return id_; }
  [[nodiscard]] int width_px() const override { return width_px_; }
  [[nodiscard]] int height_px() const override { return height_px_; }
  [[nodiscard]] bool has_colour() const override { return has_colour_; }
  /// kUnavailable  also of a camera that does not hold an exposure: what it photographs cannot be compared.
  Result<ScanPhotograph> photograph(double exposure_s) override;
  [[nodiscard]] double exposed_s(double) const override { return exposed_s_; }

 private:
  FrameScanCamera(Opener opener, const Clock& clock) : opener_(std::move(opener)), clock_(clock) {}
  Result<std::shared_ptr<const camera::CameraFrame>> next(double exposure_s);

  Opener opener_;
  const Clock& clock_;
  std::unique_ptr<camera::Camera> camera_;
  double exposure_s_ = 0.0;  ///< As it was opened.
  double exposed_s_ = 0.0;   ///< As it told with its last frame.
  std::string id_;
  int width_px_ = 0;
  int height_px_ = 0;
  bool has_colour_ = false;
};

}  // namespace cyclorama::scan
