// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/camera_monitor.h"

#include <algorithm>
#include <cmath>

#include "appliance/calibration/pose_step.h"
#include "common/base/check.h"

namespace cyclorama::healing {
namespace {

// Predictions are reused for pose changes below these limits, about a twentieth of a projector pixel. Patch shifts stay
// valid because they are measured relative to the pose of the prediction.
constexpr double kSameTurn_rad = 3e-5;
constexpr double kSameShift_m = 1e-4;

template <typename Body>
bool is_same(const RigidTransform<frame::Room, Body>& a, const RigidTransform<frame::Room, Body>& b) {
  const calibration::PoseStep step = calibration::step_between(a, b);
  return step.head<3>().norm() < kSameTurn_rad && step.tail<3>().norm() < kSameShift_m;
}

}  // namespace

CameraMonitor::CameraMonitor(const calibration::ShowCalibration& room, std::size_t camera, int width_px,
                             const PatchOptions& patches)
    : camera_(camera),
      patches_(patches),
      room_(room),
      slopes_(camera_slopes(room.cameras[camera],
                            std::max(1, static_cast<int>(std::lround(
                                            static_cast<double>(room.cameras[camera].lens.width_px) / width_px))))),
      wall_(seen_wall(room.wall, room.cameras[camera], slopes_)) {
  for (const calibration::ShowProjector& projector : room.projectors) lit_.push_back(lit_part(wall_, projector));
  edges_ = edge_points(room.wall, room.cameras[camera], slopes_, wall_);
}

int CameraMonitor::head_factor(const calibration::ShowCalibration& room) const {
  CHECK(room.projectors.size() == lit_.size());
  double min = 8.0;
  for (std::size_t i = 0; i < lit_.size(); ++i) {
    if (lit_[i].end_row > lit_[i].first_row) min = std::min(min, footprint_px(wall_, lit_[i]));
  }
  return std::clamp(static_cast<int>(std::lround(min)), 1, 8);
}

void CameraMonitor::set_room(const calibration::ShowCalibration& room) {
  const bool is_camera_same = is_same(room.cameras[camera_].T_room_camera, room_.cameras[camera_].T_room_camera);
  if (!is_camera_same) {
    room_.cameras[camera_] = room.cameras[camera_];
    wall_ = seen_wall(room_.wall, room_.cameras[camera_], slopes_);
    edges_ = edge_points(room_.wall, room_.cameras[camera_], slopes_, wall_);
  }
  for (std::size_t i = 0; i < lit_.size(); ++i) {
    if (is_camera_same && is_same(room.projectors[i].T_room_projector, room_.projectors[i].T_room_projector)) continue;
    room_.projectors[i] = room.projectors[i];
    lit_[i] = lit_part(wall_, room_.projectors[i]);
  }
}

void CameraMonitor::compare(double usual_gain, CameraObservation* look) const {
  look->prediction = predict(wall_, lit_, look->shone, slopes_.factor);
  look->scale = light_scale(look->prediction, look->seen);
  const double gain = usual_gain > 0.0 ? usual_gain : look->scale.gain;
  look->patches = align_patches(look->prediction, look->seen, gain, patches_);
  const std::vector<EdgePoint> lit = lit_across(edges_, room_, camera_, slopes_.factor, look->shone);
  look->edges = observe_edges(lit, camera_, look->prediction, look->seen, gain);
}

std::vector<PatchShift> CameraMonitor::compare(std::span<const LightPlane> shone, double gain,
                                               const LightPlane& seen) const {
  return align_patches(predict(wall_, lit_, shone, slopes_.factor), seen, gain, patches_);
}

}  // namespace cyclorama::healing
