// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/healing/estimator/areas.h"
#include "appliance/healing/estimator/screen_edges.h"
#include "appliance/healing/estimator/show_timeline.h"

namespace cyclorama::healing {

/// A camera's picture of the show.
struct CameraPicture {
  std::size_t camera = 0;
  TimePoint opened;
  TimePoint closed;
  std::shared_ptr<const GreyImage> picture;
};

/// One camera's picture and its prediction.
struct CameraObservation {
  std::size_t camera = 0;
  LightPlane seen;  ///< Softened.
  std::vector<LightPlane> shone;
  Prediction prediction;
  LightScale scale;
  std::vector<PatchShift> patches;
  std::vector<EdgeObservation> edges;
  double blown = 0.0;      ///< Share of overexposed pixels.
  double motion_px = 0.0;  ///< Motion of the shown content, for the fastest projector.
};

/// Predicts for one camera, and caches everything that changes only with poses. Thread-bound.
class CameraMonitor {
 public:
  /// Precondition: room.cameras[camera] exists. `width_px`: approximate width of the reduced pictures.
  CameraMonitor(const calibration::ShowCalibration& room, std::size_t camera, int width_px,
                const PatchOptions& patches);

  [[nodiscard]] int factor() const { return slopes_.factor; }
  /// Returns the factor by which head pictures may be reduced for this camera, so that their pixels are about as large
  /// as its own.
  [[nodiscard]] int head_factor(const calibration::ShowCalibration& room) const;

  /// Recomputes the warps for poses that differ noticeably from the former ones.
  void set_room(const calibration::ShowCalibration& room);
  /// Room that the warps were made for; it lags a little behind the believed one.
  [[nodiscard]] const calibration::ShowCalibration& predicted_room() const { return room_; }

  /// Fills prediction, scale, patches and edges of `look`, whose pictures are set. `usual_gain` 0: not known yet.
  void compare(double usual_gain, CameraObservation* look) const;
  /// Returns the patches of `seen` under the assumption that `shone` was projected.
  [[nodiscard]] std::vector<PatchShift> compare(std::span<const LightPlane> shone, double gain,
                                                const LightPlane& seen) const;

 private:
  std::size_t camera_;
  PatchOptions patches_;
  calibration::ShowCalibration room_;
  CameraSlopes slopes_;
  SeenWall wall_;
  std::vector<LitPart> lit_;
  std::vector<EdgePoint> edges_;
};

}  // namespace cyclorama::healing
