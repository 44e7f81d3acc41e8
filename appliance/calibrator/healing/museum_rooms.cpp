// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "appliance/calibrator/healing/show_rooms.h"
#include "appliance/calibrator/lens/camera_file.h"
#include "appliance/calibrator/scan/frame_scan_camera.h"
#include "drivers/camera/make_camera.h"

namespace cyclorama {
namespace {

constexpr Duration kForAFrame = std::chrono::seconds(1);

Result<std::unique_ptr<Camera>> open_camera(const std::string& spec, double exposure_s, const Clock& clock) {
  const std::string more =
      fmt::format("{}{}exposure_ms={}", spec, spec.find('?') == std::string::npos ? '?' : '&', 1e3 * exposure_s);
  // Brightness is compared between pictures. libcamera's cameras hold their gain with a fixed exposure.
  return make_camera(spec.starts_with("v4l2:") ? more + "&gain=held" : more, clock);
}

class MuseumRoom final : public ShowRoom {
 public:
  MuseumRoom(std::unique_ptr<RemoteShown> shown, std::vector<CameraPlug> plugs, double exposure_s, const Clock& clock)
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
  Result<std::shared_ptr<const Frame>> frame_of(std::size_t i) {
    if (cameras_[i] == nullptr) {
      TRY_ASSIGN(std::unique_ptr<Camera> camera, open_camera(plugs_[i].spec, exposure_s_, clock_));
      TRY(camera->start());
      cameras_[i] = std::move(camera);
    }
    auto frame = cameras_[i]->next_frame(clock_.now() + kForAFrame);
    // Perhaps it comes back.
    if (!frame && frame.error().code() == ErrorCode::kUnavailable) cameras_[i].reset();
    return frame;
  }

  std::unique_ptr<RemoteShown> shown_;
  std::vector<CameraPlug> plugs_;
  std::vector<std::unique_ptr<Camera>> cameras_;
  double exposure_s_;
  const Clock& clock_;
};

class MuseumRooms final : public ShowRooms {
 public:
  MuseumRooms(ShowDisplays displays, std::vector<CameraPlug> plugs, std::vector<WatchingCamera> cameras,
              double exposure_s, const Clock& clock)
      : displays_(std::move(displays)),
        plugs_(std::move(plugs)),
        cameras_(std::move(cameras)),
        exposure_s_(exposure_s),
        clock_(clock) {}

  [[nodiscard]] const std::vector<WatchingCamera>& cameras() const override { return cameras_; }
  [[nodiscard]] int picture_factor() const override { return displays_.factor; }
  Result<std::unique_ptr<ShowRoom>> open() override {
    TRY_ASSIGN(auto shown, RemoteShown::open(displays_.projectors, displays_.displays, displays_.factor,
                                             displays_.latency, clock_));
    return std::unique_ptr<ShowRoom>(new MuseumRoom(std::move(shown), plugs_, exposure_s_, clock_));
  }
  Result<PlacingDevices> open_for_placing() override {
    PlacingDevices devices;
    for (const CameraPlug& plug : plugs_) {
      const auto opener = [spec = plug.spec, this](double exposure_s) { return open_camera(spec, exposure_s, clock_); };
      TRY_ASSIGN(auto camera, FrameScanCamera::open(opener, exposure_s_, clock_));
      devices.cameras.push_back(std::move(camera));
    }
    TRY_ASSIGN(devices.screen, RemotePatternScreen::open(displays_.projectors, displays_.displays, displays_.settle));
    return devices;
  }

 private:
  ShowDisplays displays_;
  std::vector<CameraPlug> plugs_;
  std::vector<WatchingCamera> cameras_;
  double exposure_s_;
  const Clock& clock_;
};

}  // namespace

Result<CameraPlug> parse_camera_plug(const std::string& text) {
  const std::size_t equals = text.find('=');
  CameraPlug plug;
  if (equals != std::string::npos) plug = {text.substr(0, equals), text.substr(equals + 1)};
  const bool is_name = !plug.name.empty() && plug.name.size() <= 60 && plug.name[0] != '.' &&
                       std::ranges::none_of(plug.name, [](char c) { return c == '/' || c < ' '; });
  if (is_name && !plug.spec.empty()) return plug;
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("'{}' names no camera; write NAME=CAMERA, such as left=v4l2:usb-0000:00:14.0-2", text));
}

Result<std::unique_ptr<ShowRooms>> museum_rooms(ShowDisplays displays, const std::vector<CameraPlug>& cameras,
                                                const std::filesystem::path& lenses, double exposure_s,
                                                const Clock& clock) {
  std::vector<WatchingCamera> watching;
  for (const CameraPlug& plug : cameras) {
    auto file = read_camera(lenses / (plug.name + ".json"));
    if (!file) {
      return std::move(file).error().while_doing(
          fmt::format("reading the lens of camera '{}', which cyclorama-calibrate-camera measures", plug.name));
    }
    const MeasuredLens& lens = file->lens;
    const auto value = [&](MeasuredLens::Parameter which) { return lens.values[static_cast<std::size_t>(which)]; };
    watching.push_back(
        {plug.name,
         {lens.width_px, lens.height_px, value(MeasuredLens::kFocal), value(MeasuredLens::kFocal),
          value(MeasuredLens::kCentreU), value(MeasuredLens::kCentreV), value(MeasuredLens::kK1),
          value(MeasuredLens::kK2), value(MeasuredLens::kP1), value(MeasuredLens::kP2), value(MeasuredLens::kK3)}});
  }
  return std::unique_ptr<ShowRooms>(
      new MuseumRooms(std::move(displays), cameras, std::move(watching), exposure_s, clock));
}

}  // namespace cyclorama
