// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/frame_scan_camera.h"

#include <fmt/format.h>

#include <algorithm>

namespace cyclorama::scan {
namespace {

constexpr double kWait_s = 3.0;  // Added to the exposure, since some cameras take that long to start.
/// Number of frames that are skipped after opening, since the first frames do not have the new exposure yet.
constexpr int kWarmUpFrames = 4;

constexpr float kCode = 1.0f / 255.0f;

ScanPhotograph photograph_of(const camera::CameraFrame& frame) {
  ScanPhotograph photograph(frame.pixels.width(), frame.pixels.height());
  if (!frame.colour.empty()) {
    std::ranges::transform(frame.colour.data(), photograph.data().begin(),
                           [](std::uint8_t code) { return static_cast<float>(code) * kCode; });
    return photograph;
  }
  for (std::size_t i = 0; i < frame.pixels.data().size(); ++i) {
    const float value = static_cast<float>(frame.pixels.data()[i]) * kCode;
    std::fill_n(photograph.data().begin() + static_cast<std::ptrdiff_t>(3 * i), 3, value);
  }
  return photograph;
}

}  // namespace

Result<std::unique_ptr<FrameScanCamera>> FrameScanCamera::open(Opener opener, double exposure_s, const Clock& clock) {
  std::unique_ptr<FrameScanCamera> camera(new FrameScanCamera(std::move(opener), clock));
  TRY_ASSIGN(const std::shared_ptr<const camera::CameraFrame> frame, camera->next(exposure_s));
  camera->id_ = camera->camera_->id();
  camera->width_px_ = frame->pixels.width();
  camera->height_px_ = frame->pixels.height();
  camera->has_colour_ = !frame->colour.empty();
  return camera;
}

FrameScanCamera::~FrameScanCamera() {
  if (camera_) camera_->stop();
}

Result<std::shared_ptr<const camera::CameraFrame>> FrameScanCamera::next(double exposure_s) {
  if (!(exposure_s > 0.0 && exposure_s <= 10.0)) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("an exposure of {} s; take one of up to 10 s", exposure_s));
  }
  int warm_up = 0;
  if (!camera_ || exposure_s != exposure_s_) {
    if (camera_) camera_->stop();
    camera_.reset();  // Closed before it is opened again, since a device allows one user at a time.
    TRY_ASSIGN(camera_, opener_(exposure_s));
    if (auto started = camera_->start(); !started) {
      camera_.reset();
      return std::move(started).error();
    }
    exposure_s_ = exposure_s;
    warm_up = kWarmUpFrames;
  }
  const TimePoint asked_at = clock_.now();
  const TimePoint deadline =
      asked_at + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(kWait_s + 8.0 * exposure_s));
  for (;;) {
    auto frame = camera_->next_frame(deadline);
    if (!frame) {
      if (frame.error().code() == ErrorCode::kUnavailable) camera_.reset();  // The next photograph opens it again.
      return frame;
    }
    // Some drivers report the end of the exposure as its start. From one exposure after the request on, either stamp is
    // safe.
    const TimePoint begins_at = asked_at + (*frame)->exposure;
    if ((*frame)->captured_at >= begins_at && warm_up-- <= 0) return frame;
    if (clock_.now() >= deadline) {
      return Error(
          ErrorCode::kTimedOut,
          fmt::format("camera '{}' gives no new picture within {:.1f} s; plug it in again", camera_->id(), kWait_s));
    }
  }
}

Result<ScanPhotograph> FrameScanCamera::photograph(double exposure_s) {
  TRY_ASSIGN(const std::shared_ptr<const camera::CameraFrame> frame, next(exposure_s));
  if (frame->exposure <= Duration::zero()) {
    return Error(
        ErrorCode::kUnavailable,
        fmt::format("camera '{}' does not hold an exposure, so its pictures cannot be compared; take one whose "
                    "exposure can be set by hand",
                    id_));
  }
  exposed_s_ = to_seconds(frame->exposure);
  return photograph_of(*frame);
}

}  // namespace cyclorama::scan
