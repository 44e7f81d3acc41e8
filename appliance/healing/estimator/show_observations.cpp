// SPDX-License-Identifier: Apache-2.0
// Compares cameras' pictures with their predictions, and decides which pictures of a step count.
#include <fmt/format.h>

#include <algorithm>

#include "appliance/healing/estimator/continuous_state.h"
#include "appliance/healing/estimator/exposure_timing.h"

namespace cyclorama::healing {
namespace {

constexpr int kMinPatches = 12;
constexpr double kMaxSaturatedShare = 0.25;
constexpr double kGainShare = 0.2;  // Rate at which a camera's gain is updated.
constexpr Duration kTimeStep = kTimeDoubt / 2;
constexpr Duration kMaxTimeOffset = std::chrono::milliseconds(200);

}  // namespace

std::optional<std::vector<LightPlane>> ContinuousCalibrator::State::shone_between(TimePoint opened, TimePoint closed,
                                                                                  double* ret_motion_px) {
  std::vector<LightPlane> shone;
  for (ShowTimeline& timeline : timelines) {
    auto exposed = timeline.between(opened, closed);
    if (!exposed) return std::nullopt;
    *ret_motion_px = std::max(*ret_motion_px, exposed->motion_px);
    shone.push_back(std::move(exposed->light));
  }
  return shone;
}

bool ContinuousCalibrator::State::is_still(TimePoint from, TimePoint until) {
  return std::ranges::all_of(timelines, [&](ShowTimeline& timeline) { return timeline.is_still(from, until); });
}

bool ContinuousCalibrator::State::is_of_its_time(const CameraObservation& look, TimePoint opened, TimePoint closed,
                                                 TimePoint now, ShowReport* report) {
  double ignored_px = 0.0;
  const auto earlier = shone_between(opened - kTimeDoubt, closed - kTimeDoubt, &ignored_px);
  const auto later = shone_between(opened + kTimeDoubt, closed + kTimeDoubt, &ignored_px);
  if (!earlier || !later) return false;
  const CameraMonitor& eye = cameras[look.camera];
  const double gain = gains[look.camera] > 0.0 ? gains[look.camera] : look.scale.gain;
  const ExposureTiming time = estimate_timing(look.patches, eye.compare(*earlier, gain, look.seen),
                                              eye.compare(*later, gain, look.seen), projectors());
  if (time.towards != 0) {
    Duration& off = times_off[look.camera];
    off = std::clamp<Duration>(off + time.towards * kTimeStep, -kMaxTimeOffset, kMaxTimeOffset);
    report->log.push_back(fmt::format("{}: camera '{}' sees what was shown {} ms {} than it says",
                                      clock_text(*begun_at, now), believed.cameras[look.camera].name,
                                      std::chrono::abs(off) / std::chrono::milliseconds(1),
                                      off < Duration::zero() ? "earlier" : "later"));
  }
  return time.is_its_own;
}

void ContinuousCalibrator::State::look_at(const ShowMoment& moment, ShowReport* report) {
  looks.clear();
  is_moving = false;
  is_calm = true;
  HoldReason why = HoldReason::kNoPicture;
  std::string reason = "no camera's picture came";
  for (const CameraPicture& taken : moment.seen) {
    if (taken.camera >= cameras.size() || !taken.picture) continue;
    const calibration::ShowCamera& camera = believed.cameras[taken.camera];
    if (taken.picture->width() != camera.lens.width_px || taken.picture->height() != camera.lens.height_px) {
      reason = fmt::format("camera '{}' gives pictures of another size than it was calibrated with", camera.name);
      continue;
    }
    CameraObservation look;
    look.camera = taken.camera;
    const TimePoint opened = taken.opened + times_off[taken.camera];
    const TimePoint closed = taken.closed + times_off[taken.camera];
    auto shone = shone_between(opened, closed, &look.motion_px);
    if (!shone) {
      reason = fmt::format("what was shown while camera '{}' exposed is not known; are the clocks right?", camera.name);
      continue;
    }
    look.shone = *std::move(shone);
    if (look.motion_px > options.fastest_px) {
      why = HoldReason::kFast;
      reason = "the picture moves too fast";
      continue;
    }
    look.seen = seen_light(*taken.picture, camera, cameras[taken.camera].factor(), &look.blown);
    if (look.blown > kMaxSaturatedShare) {
      why = HoldReason::kBlown;
      reason = fmt::format("camera '{}' is dazzled; shorten its exposure", camera.name);
      continue;
    }
    soften(&look.seen);
    CameraMonitor& eye = cameras[taken.camera];
    eye.set_room(believed);
    eye.compare(gains[taken.camera], &look);
    const auto compared = std::ranges::count_if(look.patches, [](const PatchShift& patch) {
      return patch.fit == PatchFit::kFits || patch.fit == PatchFit::kDiffers;
    });
    if (compared >= kMinPatches && !is_still(opened - kTimeDoubt, closed + kTimeDoubt)) {
      is_moving = true;
      if (!is_of_its_time(look, opened, closed, moment.now, report)) {
        why = HoldReason::kFast;
        reason = fmt::format("the picture moves, and camera '{}' does not see what was shown at the time that it says",
                             camera.name);
        continue;
      }
    }
    is_calm = is_calm && is_still(closed - kCalmFor, closed);
    double& gain = gains[taken.camera];
    const auto fits = std::ranges::count(look.patches, PatchFit::kFits, &PatchShift::fit);
    if (look.scale.gain > 0.0 && fits >= kMinPatches)
      gain = gain > 0.0 ? gain + kGainShare * (look.scale.gain - gain) : look.scale.gain;
    looks.push_back(std::move(look));
  }
  if (!looks.empty()) {
    if (!is_moving) still_at = moment.now;
    return;
  }
  for (std::size_t i = 0; i < projectors(); ++i) hold(i, why, reason, moment.now, report);
}

}  // namespace cyclorama::healing
