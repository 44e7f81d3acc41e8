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
  LightPlane seen;  ///< After soften().
  std::vector<LightPlane> shone;
  Prediction prediction;
  LightScale scale;
  std::vector<PatchShift> patches;
  std::vector<EdgeObservation> edges;
  double blown = 0.0;      ///< Share of overexposed pixels.
  double motion_px = 0.0;  ///< Largest motion of the shown content, over the projectors.
};

/// Predicts what one camera sees of the show, and caches everything that depends only on poses. Thread-bound.
class CameraMonitor {
 public:
  /// `width_px` is the approximate width of the reduced pictures. Precondition: room.cameras[camera] exists.
  CameraMonitor(const calibration::ShowCalibration& room, std::size_t camera, int width_px,
                const PatchOptions& patches);

  [[nodiscard]] int factor() const { return slopes_.factor; }
  /// Returns the factor by which the heads' pictures may be reduced so that their pixels on the wall are about as large
  /// as this camera's.
  [[nodiscard]] int head_factor(const calibration::ShowCalibration& room) const;

  /// Recomputes the warps for poses that differ noticeably from the former ones.
  void set_room(const calibration::ShowCalibration& room);
  /// Returns the room for which the warps were computed; it may differ slightly from the one last set.
  [[nodiscard]] const calibration::ShowCalibration& predicted_room() const { return room_; }

  /// Fills the prediction, scale, patches and edges of `look`, whose `seen` and `shone` are set. `usual_gain` is 0 if
  /// it is not known yet.
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
