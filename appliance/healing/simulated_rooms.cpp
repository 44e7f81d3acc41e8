// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "appliance/healing/show_rooms.h"

namespace cyclorama::healing {
namespace {

constexpr double kExposure_s = 0.04;

class SimulatedShowRoom final : public ShowRoom {
 public:
  SimulatedShowRoom(std::unique_ptr<RemoteShown> shown, simulated::SimulatedStage* stage, const Clock& clock)
      : shown_(std::move(shown)), stage_(*stage), clock_(clock) {}

  /// The stage does not simulate time: its cameras see the last pictures that were shown while their shutters were
  /// open.
  Result<ShowMoment> next(std::vector<std::string>*) override {
    ShowMoment moment;
    const TimePoint closed = clock_.now();
    const TimePoint opened = closed - std::chrono::duration_cast<Duration>(std::chrono::duration<double>(kExposure_s));
    TRY_ASSIGN(RemoteShown::Shown shown, shown_->between(opened, closed));
    for (const ShownPicture& picture : shown.pictures) TRY(stage_.show(picture.projector, *picture.picture));
    for (std::size_t i = 0; shown.is_show && i < stage_.camera_count(); ++i) {
      TRY_ASSIGN(GreyImage seen, stage_.photograph(i, kExposure_s));
      moment.seen.push_back({i, opened, closed, std::make_shared<const GreyImage>(std::move(seen))});
    }
    moment.shown = std::move(shown.pictures);
    moment.until = std::move(shown.until);
    moment.now = clock_.now();
    return moment;
  }

 private:
  std::unique_ptr<RemoteShown> shown_;
  simulated::SimulatedStage& stage_;
  const Clock& clock_;
};

class StageScreen final : public scan::PatternScreen {
 public:
  StageScreen(simulated::SimulatedStage* stage, const std::vector<InstalledProjector>& projectors)
      : stage_(*stage), projectors_(projectors) {
    for (std::size_t i = 0; i < projectors_.size(); ++i) {
      const Status ignored = show(i, RgbImage());
      static_cast<void>(ignored);
    }
  }
  Status show(std::size_t projector, const RgbImage& picture) override {
    if (projector >= projectors_.size())
      return Error(ErrorCode::kInvalidArgument, fmt::format("there is no projector {}", projector));
    const Pinhole& lens = projectors_[projector].lens;
    return stage_.show(projector, picture.empty() ? RgbImage(lens.width_px, lens.height_px) : picture);
  }

 private:
  simulated::SimulatedStage& stage_;
  const std::vector<InstalledProjector>& projectors_;
};

class StageCamera final : public scan::ScanCamera {
 public:
  StageCamera(simulated::SimulatedStage* stage, std::size_t camera)
      : stage_(*stage), camera_(camera), lens_(stage->lens(camera)), id_(fmt::format("simulated {}", camera + 1)) {}
  [[nodiscard]] const std::string& id() const override { return id_; }
  [[nodiscard]] int width_px() const override { return lens_.width_px; }
  [[nodiscard]] int height_px() const override { return lens_.height_px; }
  [[nodiscard]] bool has_colour() const override { return false; }
  Result<scan::ScanPhotograph> photograph(double exposure_s) override {
    TRY_ASSIGN(const GreyImage codes, stage_.photograph(camera_, exposure_s));
    scan::ScanPhotograph photograph(codes.width(), codes.height());
    for (std::size_t i = 0; i < photograph.data().size(); ++i)
      photograph.data()[i] = static_cast<float>(codes.data()[i / 3]) / 255.0f;
    return photograph;
  }

 private:
  simulated::SimulatedStage& stage_;
  std::size_t camera_;
  simulated::SimulatedStage::Lens lens_;
  std::string id_;
};

class SimulatedRooms final : public ShowRooms {
 public:
  SimulatedRooms(ShowDisplays displays, simulated::SimulatedStage stage, const Clock& clock)
      : displays_(std::move(displays)), stage_(std::move(stage)), clock_(clock) {
    for (std::size_t i = 0; i < stage_.camera_count(); ++i) {
      const simulated::SimulatedStage::Lens lens = stage_.lens(i);
      cameras_.push_back(
          {fmt::format("camera {}", i + 1),
           {lens.width_px, lens.height_px, lens.focal_px, lens.focal_px, lens.centre_u_px, lens.centre_v_px,
            lens.radial[0], lens.radial[1], lens.tangential[0], lens.tangential[1], lens.radial[2]}});
    }
  }
  [[nodiscard]] const std::vector<WatchingCamera>& cameras() const override { return cameras_; }
  [[nodiscard]] int picture_factor() const override { return displays_.factor; }
  Result<std::unique_ptr<ShowRoom>> open() override {
    TRY_ASSIGN(auto shown, RemoteShown::open(displays_.projectors, displays_.displays, displays_.factor,
                                             displays_.latency, clock_));
    return std::unique_ptr<ShowRoom>(new SimulatedShowRoom(std::move(shown), &stage_, clock_));
  }
  Result<PlacementDevices> open_for_placement() override {
    PlacementDevices devices;
    for (std::size_t i = 0; i < stage_.camera_count(); ++i)
      devices.cameras.push_back(std::make_unique<StageCamera>(&stage_, i));
    devices.screen = std::make_unique<StageScreen>(&stage_, displays_.projectors);
    return devices;
  }

 private:
  ShowDisplays displays_;
  simulated::SimulatedStage stage_;
  const Clock& clock_;
  std::vector<WatchingCamera> cameras_;
};

}  // namespace

std::unique_ptr<ShowRooms> simulated_rooms(ShowDisplays displays, simulated::SimulatedStage stage, const Clock& clock) {
  return std::make_unique<SimulatedRooms>(std::move(displays), std::move(stage), clock);
}

}  // namespace cyclorama::healing
