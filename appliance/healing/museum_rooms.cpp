// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "appliance/calibration/camera_file.h"
#include "appliance/healing/show_rooms.h"
#include "appliance/scan/frame_scan_camera.h"
#include "drivers/devices/make_camera.h"

namespace cyclorama::healing {
namespace {

constexpr Duration kForAFrame = std::chrono::seconds(1);

Result<std::unique_ptr<camera::Camera>> open_camera(const std::string& spec, double exposure_s, const Clock& clock) {
  const std::string more =
      fmt::format("{}{}exposure_ms={}", spec, spec.find('?') == std::string::npos ? '?' : '&', 1e3 * exposure_s);
  // The gain must be fixed, since brightness is compared between pictures; libcamera's cameras fix it together with the
  // exposure.
  return devices::make_camera(spec.starts_with("v4l2:") ? more + "&gain=held" : more, clock);
}

class MuseumRoom final : public ShowRoom {
 public:
  MuseumRoom(std::unique_ptr<RemoteShown> shown, std::vector<scan::CameraSource> plugs, double exposure_s,
             const Clock& clock)
      : shown_(std::move(shown)),
        plugs_(std::move(plugs)),
        cameras_(plugs_.size()),
        exposure_s_(exposure_s),
        clock_(clock) {}
  ~MuseumRoom() override {
    for (const auto& camera : cameras_) {
      if (camera != nullptr) camera->stop();
    }
  }
  MuseumRoom(const MuseumRoom&) = delete;
  MuseumRoom& operator=(const MuseumRoom&) = delete;

  Result<ShowMoment> next(std::vector<std::string>* ret_troubles) override {
    ShowMoment moment;
    const auto exposure = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(exposure_s_));
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      const auto frame = frame_of(i);
      if (!frame) {
        ret_troubles->push_back(fmt::format("camera '{}': {}", plugs_[i].name, frame.error().message()));
        continue;
      }
      const TimePoint opened = (*frame)->captured_at;
      moment.seen.push_back(
          {i, opened, opened + exposure, std::shared_ptr<const GreyImage>(*frame, &(*frame)->pixels)});
    }
    if (!moment.seen.empty()) {
      const TimePoint opened = std::ranges::min_element(moment.seen, {}, &CameraPicture::opened)->opened;
      const TimePoint closed = std::ranges::max_element(moment.seen, {}, &CameraPicture::closed)->closed;
      TRY_ASSIGN(RemoteShown::Shown shown, shown_->between(opened, closed));
      moment.shown = std::move(shown.pictures);
      moment.until = std::move(shown.until);
      if (!shown.is_show) moment.seen.clear();
    }
    moment.now = clock_.now();
    return moment;
  }

 private:
  Result<std::shared_ptr<const camera::CameraFrame>> frame_of(std::size_t i) {
    if (cameras_[i] == nullptr) {
      TRY_ASSIGN(std::unique_ptr<camera::Camera> camera, open_camera(plugs_[i].spec, exposure_s_, clock_));
      TRY(camera->start());
      cameras_[i] = std::move(camera);
    }
    auto frame = cameras_[i]->next_frame(clock_.now() + kForAFrame);
    // The next call tries to open the camera again.
    if (!frame && frame.error().code() == ErrorCode::kUnavailable) cameras_[i].reset();
    return frame;
  }

  std::unique_ptr<RemoteShown> shown_;
  std::vector<scan::CameraSource> plugs_;
  std::vector<std::unique_ptr<camera::Camera>> cameras_;
  double exposure_s_;
  const Clock& clock_;
};

class MuseumRooms final : public ShowRooms {
 public:
  MuseumRooms(ShowDisplays displays, std::vector<scan::CameraSource> plugs, std::vector<WatchingCamera> cameras,
              std::vector<std::string> troubles, double exposure_s, const Clock& clock)
      : displays_(std::move(displays)),
        plugs_(std::move(plugs)),
        cameras_(std::move(cameras)),
        troubles_(std::move(troubles)),
        exposure_s_(exposure_s),
        clock_(clock) {}

  [[nodiscard]] const std::vector<WatchingCamera>& cameras() const override { return cameras_; }
  [[nodiscard]] std::vector<std::string> troubles() const override { return troubles_; }
  [[nodiscard]] int picture_factor() const override { return displays_.factor; }
  Result<std::unique_ptr<ShowRoom>> open() override {
    TRY_ASSIGN(auto shown, RemoteShown::open(displays_.projectors, displays_.displays, displays_.factor,
                                             displays_.latency, clock_));
    return std::unique_ptr<ShowRoom>(new MuseumRoom(std::move(shown), plugs_, exposure_s_, clock_));
  }
  Result<PlacementDevices> open_for_placement() override {
    PlacementDevices devices;
    for (const scan::CameraSource& plug : plugs_) {
      const auto opener = [spec = plug.spec, this](double exposure_s) { return open_camera(spec, exposure_s, clock_); };
      TRY_ASSIGN(auto camera, scan::FrameScanCamera::open(opener, exposure_s_, clock_));
      devices.cameras.push_back(std::move(camera));
    }
    TRY_ASSIGN(devices.screen,
               scan::RemotePatternScreen::open(displays_.projectors, displays_.displays, displays_.settle));
    return devices;
  }

 private:
  ShowDisplays displays_;
  std::vector<scan::CameraSource> plugs_;
  std::vector<WatchingCamera> cameras_;
  std::vector<std::string> troubles_;
  double exposure_s_;
  const Clock& clock_;
};

/// Reads a camera's lens from the first folder that has its file. Errors: kNotFound if no folder has the file; those of
/// read_camera().
Result<calibration::CameraFile> lens_of(const std::string& camera, const std::vector<std::filesystem::path>& folders) {
  for (const std::filesystem::path& folder : folders) {
    auto file = calibration::read_camera(folder / (camera + ".json"));
    if (file || file.error().code() != ErrorCode::kNotFound) return file;
  }
  return Error(ErrorCode::kNotFound, "its lens is not known");
}

std::string without_lens(const std::string& camera, const Error& error) {
  return fmt::format(
      "camera '{0}' watches nothing: {1}; measure it with 'cyclorama calibrate-camera', and put the result into "
      "cameras/{0}.json beside calibrator.toml, or into the calibration's folder",
      camera, error.message());
}

calibration::BrownParameters brown_parameters(const calibration::MeasuredLens& lens) {
  const auto value = [&](calibration::MeasuredLens::Parameter which) {
    return lens.values[static_cast<std::size_t>(which)];
  };
  return {lens.width_px,
          lens.height_px,
          value(calibration::MeasuredLens::kFocal),
          value(calibration::MeasuredLens::kFocal),
          value(calibration::MeasuredLens::kCentreU),
          value(calibration::MeasuredLens::kCentreV),
          value(calibration::MeasuredLens::kK1),
          value(calibration::MeasuredLens::kK2),
          value(calibration::MeasuredLens::kP1),
          value(calibration::MeasuredLens::kP2),
          value(calibration::MeasuredLens::kK3)};
}

}  // namespace

std::unique_ptr<ShowRooms> museum_rooms(ShowDisplays displays, const std::vector<scan::CameraSource>& cameras,
                                        const std::vector<std::filesystem::path>& lenses, double exposure_s,
                                        const Clock& clock) {
  std::vector<scan::CameraSource> plugs;
  std::vector<WatchingCamera> watching;
  std::vector<std::string> troubles;
  for (const scan::CameraSource& plug : cameras) {
    const auto file = lens_of(plug.name, lenses);
    if (!file) {
      troubles.push_back(without_lens(plug.name, file.error()));
      continue;
    }
    plugs.push_back(plug);
    watching.push_back({plug.name, brown_parameters(file->lens)});
  }
  return std::make_unique<MuseumRooms>(std::move(displays), std::move(plugs), std::move(watching), std::move(troubles),
                                       exposure_s, clock);
}

}  // namespace cyclorama::healing
