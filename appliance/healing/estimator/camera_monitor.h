// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "appliance/healing/estimator/areas.h"
#include "appliance/healing/estimator/screen_edges.h"
#include "appliance/healing/estimator/show_timeline.h"

namespace cyclorama::healing {

/// A picture that a camera took of the show.
struct CameraPicture {
  std::size_t camera = 0;
  TimePoint opened;
  TimePoint closed;
  std::shared_ptr<const GreyImage> picture;
};

/// One camera's picture and what it was expected to be.
struct CameraObservation {
  std::size_t camera = 0;
  LightPlane seen;  ///< Softened.
  std::vector<LightPlane> shone;
  Prediction prediction;
  LightScale scale;
  std::vector<PatchShift> patches;
  std::vector<EdgeObservation> edges;
  double blown = 0.0;      ///< Part of the pixels.
  double motion_px = 0.0;  ///< Of what was shown, the fastest projector.
};

/// Predicts for one camera, and keeps what only poses change. Thread-bound.
class CameraMonitor {
 public:
  /// Precondition: room.cameras[camera] is there. `width_px`: about how wide pictures are made.
  CameraMonitor(const calibration::ShowCalibration& room, std::size_t camera, int width_px,
                const PatchOptions& patches);

  [[nodiscard]] int factor() const { return slopes_.factor; }
  /// By what head pictures may be reduced for this camera, so that their pixels are about its own.
  [[nodiscard]] int head_factor(const calibration::ShowCalibration& room) const;

  /// Warps are made anew for poses that differ from those of before by more than what moves nothing.
  void set_room(const calibration::ShowCalibration& room);
  /// What the warps were made for: a little behind what is believed.
  [[nodiscard]] const calibration::ShowCalibration& predicted_room() const { return room_; }

  /// Fills prediction, scale, patches and edges of a look whose pictures are there. `usual_gain` 0: not known yet.
  void compare(double usual_gain, CameraObservation* look) const;
  /// The patches of `seen`, had this been shone.
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
