// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>

#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "drivers/output/shared_picture.h"
#include "drivers/simulated/room/room_picture.h"
#include "drivers/simulated/room/stereo_glasses.h"

namespace cyclorama::simulated {
namespace {

constexpr auto kShutdownGrace = std::chrono::milliseconds(200);
constexpr const char* kPicture = "wall";
// In stereo, the view of the right eye through the glasses; kPicture is that of the left eye.
constexpr const char* kRightPicture = "wall-right";

struct Settings {
  std::string installation;
  std::string run_dir;
  std::string listen = "[::1]:0";
  double rate_hz = 10.0;
  int width_px = 960;
};

/// Pictures of one projector. They are opened when its head appears, and reopened after a restart of the display.
class ProjectorLight {
 public:
  explicit ProjectorLight(std::filesystem::path path) : path_(std::move(path)) {}

  /// Reads the newest picture. While the display is away, the last picture stays, as on a projector that holds the last
  /// frame of a lost signal.
  void refresh(RgbImage* picture) {
    if (!reader_) {
      auto opened = output::SharedPictureReader::open(path_);
      if (!opened) return;
      reader_.emplace(std::move(*opened));
    }
    const auto info = reader_->read_newest(picture);
    is_lit_ = info.has_value();
    if (info) refresh_ = static_cast<std::int64_t>(info->refresh);
    if (!info && info.error().code() == ErrorCode::kUnavailable) reader_.reset();
  }
  [[nodiscard]] bool is_lit() const { return is_lit_; }
  /// Number of the refresh at which the display showed the picture.
  [[nodiscard]] std::int64_t refresh_number() const { return refresh_; }

 private:
  std::filesystem::path path_;
  std::optional<output::SharedPictureReader> reader_;
  std::int64_t refresh_ = 0;
  bool is_lit_ = false;
};

/// Newest picture of a head for each eye. The refresh number of a display decides between alternating eyes.
/// Synchronised displays alternate by the synchronised refresh instead, so left and right may be exchanged in a room
/// with several displays.
class TwoEyes {
 public:
  explicit TwoEyes(StereoPacking packing) : packing_(packing) {}
  void look(const std::vector<ProjectorLight>& lights, const std::vector<RgbImage>& heads) {
    for (std::vector<RgbImage>* const seen : {&left_, &right_}) seen->resize(heads.size());
    for (std::size_t i = 0; i < heads.size(); ++i) {
      const Eye now = eye_at(lights[i].refresh_number());
      const bool takes_turns = packing_ == StereoPacking::kFrameSequential;
      if (!takes_turns || now == Eye::kLeft) left_[i] = seen_through_glasses(heads[i], packing_, Eye::kLeft);
      if (!takes_turns || now == Eye::kRight) right_[i] = seen_through_glasses(heads[i], packing_, Eye::kRight);
    }
  }
  [[nodiscard]] const std::vector<RgbImage>& left() const { return left_; }
  [[nodiscard]] const std::vector<RgbImage>& right() const { return right_; }

 private:
  StereoPacking packing_;
  std::vector<RgbImage> left_;
  std::vector<RgbImage> right_;
};

Status run(const Settings& settings, const StopSignal& stop) {
  TRY_ASSIGN(const Installation installation, read_installation(settings.installation));
  InspectionService inspection("simulated-room");
  TRY_ASSIGN(const auto server, WireServer::start(settings.listen, {&inspection}));
  log(LogLevel::kInfo, fmt::format("simulated room '{}' with {} projectors, port {}", installation.name,
                                   installation.projectors.size(), server->port()));

  RoomPicture room(installation, RoomEye::behind_visitor(installation, settings.width_px, settings.width_px * 9 / 16));
  std::vector<ProjectorLight> lights;
  for (const InstalledProjector& projector : installation.projectors) {
    lights.emplace_back(output::shared_picture_path(settings.run_dir, projector.name));
  }
  std::vector<RgbImage> pictures(lights.size());
  std::optional<TwoEyes> eyes;
  if (installation.stereo) eyes.emplace(installation.stereo->packing);

  Notify notify;
  notify.ready();
  const SteadyClock clock;
  const auto period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / settings.rate_hz));
  for (TimePoint next = clock.now(); !stop.wait_until(next); next = std::max(next + period, clock.now())) {
    notify.keep_alive(clock.now());
    std::size_t lit = 0;
    const bool watched = inspection.is_watched(kPicture);
    const bool is_right_watched = eyes && inspection.is_watched(kRightPicture);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      lights[i].refresh(&pictures[i]);
      if (lights[i].is_lit()) ++lit;
    }
    inspection.set_gauge("projectors_lit", static_cast<double>(lit));
    inspection.set_state(lit == lights.size()
                             ? fmt::format("all {} projectors are lit", lit)
                             : fmt::format("{} of {} projectors are lit; is the display running?", lit, lights.size()),
                         lit == lights.size());
    if (!watched && !is_right_watched) continue;
    const TimePoint begun = clock.now();
    if (eyes) eyes->look(lights, pictures);
    if (watched)
      inspection.set_picture(kPicture,
                             std::make_shared<const RgbImage>(room.photograph(eyes ? eyes->left() : pictures)));
    if (is_right_watched)
      inspection.set_picture(kRightPicture, std::make_shared<const RgbImage>(room.photograph(eyes->right())));
    inspection.add_stage_time("photograph", clock.now() - begun);
  }
  notify.stopping();
  server->stop(kShutdownGrace);
  return Done{};
}

}  // namespace
}  // namespace cyclorama::simulated

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::simulated;
  Program program("cyclorama-simulated-room",
                  "A simulated room: lights a wall with what the heads show, and photographs it.");
  Settings settings;
  CLI::App& options = program.options();
  options.add_option("--installation", settings.installation, "installation.toml: the room")->required();
  options.add_option("--run-dir", settings.run_dir, "Where the display publishes its heads' pictures")->required();
  options.add_option("--listen", settings.listen, "Address for the operator")->capture_default_str();
  options.add_option("--rate-hz", settings.rate_hz, "Photographs per second, while a client requests them")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  options.add_option("--width", settings.width_px, "Width of the photograph in pixels (16:9)")
      ->check(CLI::Range(64, 4096))
      ->capture_default_str();
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(settings, stop); });
}
