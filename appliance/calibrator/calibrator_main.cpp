// SPDX-License-Identifier: Apache-2.0
/// cyclorama-calibrator: measures the wall when it is told to, and keeps it in its place while the show goes on.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibrator/healing/healing_service.h"
#include "appliance/calibrator/healing/show_rooms.h"
#include "appliance/calibrator/scan/frame_scan_camera.h"
#include "appliance/calibrator/scan/known_lens.h"
#include "appliance/calibrator/scan/remote_pattern_screen.h"
#include "appliance/calibrator/scan/simulated_devices.h"
#include "appliance/calibrator/service/calibrator_service.h"
#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "drivers/camera/camera_spec.h"
#include "drivers/camera/make_camera.h"
#include "drivers/turnplate/make_turnplate.h"
#include "drivers/turnplate/simulated/simulated_turnplate.h"

namespace cyclorama {
namespace {

constexpr Duration kSupervisePeriod = std::chrono::milliseconds(500);
constexpr double kFirstExposure_s = 1.0 / 60.0;
/// About how wide heads' pictures are when they are compared with what cameras see.
constexpr double kWatchedWidth_px = 960.0;

struct Options {
  std::string installation;
  std::string simulated;
  std::string folder = "/var/lib/cyclorama/calibration";
  std::string listen = "[::1]:7410";
  std::string camera = "v4l2:";
  std::string turnplate = "manual";
  std::vector<std::string> displays;
  std::string lens;
  double field_of_view_deg = 70.0;
  double pitch_deg = 0.0;
  double settle_ms = 100.0;
  double longest_exposure_ms = 250.0;
  std::vector<std::string> watch;
  double watch_exposure_ms = 1e3 / 30.0;
  double watch_hz = 4.0;
  double latency_ms = 30.0;
  std::string record;
  std::string replay;
};

void add_options(CLI::App& app, Options* ret) {
  app.add_option("--installation", ret->installation, "What stands in the room (installation.toml)")->type_name("FILE");
  app.add_option(
         "--simulated", ret->simulated,
         "Calibrate a simulated museum in this process instead of the room: its installation.toml, beside which "
         "lies its truth")
      ->type_name("FILE")
      ->excludes("--installation");
  app.add_option("--folder", ret->folder, "Where calibration.json and those of before are kept")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_option("--listen", ret->listen, "Where to be told to calibrate, and to show live state to the operator")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--camera", ret->camera, "On the turn-plate: v4l2:PORT[?OPTIONS], libcamera:ID[?OPTIONS]")
      ->type_name("CAMERA")
      ->capture_default_str();
  app.add_option("--turnplate", ret->turnplate, "serial:DEVICE[?OPTIONS], or manual: asks somebody to turn it")
      ->type_name("PLATE")
      ->capture_default_str();
  app.add_option("--display", ret->displays,
                 "A display that shows the patterns; repeat it where there are several, with the names of their "
                 "projectors")
      ->type_name("[NAMES=]HOST:PORT")
      ->allow_extra_args(false);
  app.add_option("--lens", ret->lens,
                 "What 'cyclorama calibrate-camera' wrote of this camera; without it, camera.json in FOLDER where that "
                 "is of it")
      ->type_name("FILE");
  app.add_option("--field-of-view-deg", ret->field_of_view_deg,
                 "Of the width of the camera's picture, where its lens is not known")
      ->check(CLI::Range(5.0, 150.0))
      ->capture_default_str();
  app.add_option("--pitch-deg", ret->pitch_deg, "How far the camera looks up, about")
      ->check(CLI::Range(-60.0, 60.0))
      ->capture_default_str();
  app.add_option("--settle-ms", ret->settle_ms, "From a projector's signal to its light")
      ->check(CLI::Range(0.0, 2000.0))
      ->capture_default_str();
  app.add_option("--longest-exposure-ms", ret->longest_exposure_ms, "Of the camera")
      ->check(CLI::Range(1.0, 5000.0))
      ->capture_default_str();
  app.add_option("--watch", ret->watch,
                 "A fixed camera that sees the show, to keep projectors in their places by; its lens is FOLDER/cameras/"
                 "NAME.json. Repeat it for each; with --simulated and --display there is one beside each projector")
      ->type_name("NAME=CAMERA")
      ->allow_extra_args(false);
  app.add_option("--watch-exposure-ms", ret->watch_exposure_ms, "Of the fixed cameras: whole refreshes of projectors")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--watch-hz", ret->watch_hz, "How often what they see is compared with what is shown")
      ->check(CLI::Range(0.05, 10.0))
      ->capture_default_str();
  app.add_option("--latency-ms", ret->latency_ms, "From a refresh of the display to the projector's light")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--record", ret->record,
                 "Keep what is shown and seen in FOLDER/TIME for --replay; FOLDER grows to 8 GiB")
      ->type_name("FOLDER");
  app.add_option("--replay", ret->replay,
                 "Do nothing but find the corrections of a record again, tell them, and end: 0 if they are the same")
      ->type_name("FOLDER");
}

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kReadByEye_rad = 0.3 * kDegree;  // Off a scale of whole degrees.

Result<ScanSettings> settings_for(const Options& options, const ScanCamera& camera) {
  ScanSettings settings;
  TRY_ASSIGN(const std::optional<MeasuredLens> known,
             known_lens(options.lens, options.folder, camera.id(), camera.width_px(), camera.height_px()));
  settings.camera =
      known ? *known : data_sheet_lens(camera.width_px(), camera.height_px(), options.field_of_view_deg * kDegree);
  settings.pitch_rad = options.pitch_deg * kDegree;
  settings.view.exposure.longest = ExposureTime(1e-3 * options.longest_exposure_ms);
  return settings;
}

/// The museum outlives all devices: the opener holds it.
DeviceOpener simulated_opener(const Options& options, std::shared_ptr<SimulatedMuseum> museum) {
  return [options, museum]() -> Result<CalibrationDevices> {
    CalibrationDevices devices;
    devices.plate = std::make_unique<SimulatedTurnplate>(museum.get());
    devices.camera = std::make_unique<SimulatedScanCamera>(museum.get(), PhotographColour::kGrey);
    devices.colour_camera = std::make_unique<SimulatedScanCamera>(museum.get(), PhotographColour::kColour);
    devices.screen = std::make_unique<SimulatedPatternScreen>(museum.get());
    TRY_ASSIGN(devices.settings, settings_for(options, *devices.camera));
    return devices;
  };
}

Result<std::vector<PatternDisplay>> displays_of(const Options& options) {
  std::vector<PatternDisplay> displays;
  for (const std::string& text : options.displays) {
    TRY_ASSIGN(PatternDisplay display, parse_pattern_display(text));
    displays.push_back(std::move(display));
  }
  return displays;
}

/// A calibrator in a terminal asks there, a service asks whoever told it to calibrate.
std::unique_ptr<TurnplateOperator> operator_at(TurnplateDesk* desk) {
  if (::isatty(STDIN_FILENO) == 1) return std::make_unique<TerminalOperator>(STDIN_FILENO, STDERR_FILENO);
  return std::make_unique<DeskOperator>(desk);
}

Result<DeviceOpener> real_opener(const Options& options, const Installation& installation, TurnplateDesk* desk,
                                 const Clock& clock) {
  TRY_ASSIGN(const std::vector<PatternDisplay> displays, displays_of(options));
  if (displays.empty()) {
    return Error(ErrorCode::kInvalidArgument, "no display is named that shows the patterns; give --display HOST:PORT");
  }
  return DeviceOpener(
      [options, displays, projectors = installation.projectors, desk, &clock]() -> Result<CalibrationDevices> {
        const FrameScanCamera::Opener open_camera = [spec = options.camera, &clock](double exposure_s) {
          // Pictures are compared. libcamera's cameras hold their gain with a fixed exposure.
          const std::string_view held = spec.starts_with("v4l2:") ? "&gain=held" : "";
          // Where a picture takes less time than its exposure, cameras cut the exposure.
          const double rate_hz = std::min(30.0, 0.9 / exposure_s);
          return make_camera(with_defaults(spec, fmt::format("{}&frames_per_second={:.4g}&colour=yes&exposure_ms={}{}",
                                                             kCalibrationSize, rate_hz, 1e3 * exposure_s, held)),
                             clock);
        };
        CalibrationDevices devices;
        TRY_ASSIGN(devices.plate, make_turnplate(options.turnplate, operator_at(desk)));
        TRY_ASSIGN(devices.camera, FrameScanCamera::open(open_camera, kFirstExposure_s, clock));
        const auto settle = std::chrono::milliseconds(static_cast<int>(options.settle_ms));
        TRY_ASSIGN(devices.screen, RemotePatternScreen::open(projectors, displays, settle));
        TRY_ASSIGN(devices.settings, settings_for(options, *devices.camera));
        if (options.turnplate == "manual") devices.settings.plate_sigma_rad = kReadByEye_rad;
        return devices;
      });
}

/// Null: nothing watches.
Result<std::unique_ptr<ShowRooms>> rooms_of(const Options& options, const Installation& installation,
                                            const Clock& clock) {
  const bool is_simulated = !options.simulated.empty() && !options.displays.empty();
  if (!is_simulated && options.watch.empty()) return std::unique_ptr<ShowRooms>();
  if (!options.simulated.empty() && !options.watch.empty()) {
    return Error(ErrorCode::kInvalidArgument, "a simulated museum has cameras of its own; leave out --watch");
  }
  ShowDisplays shows;
  shows.projectors = installation.projectors;
  TRY_ASSIGN(shows.displays, displays_of(options));
  const auto widest = std::ranges::max(installation.projectors, {}, [](const auto& p) { return p.lens.width_px; });
  shows.factor = std::max(1, static_cast<int>(std::lround(widest.lens.width_px / kWatchedWidth_px)));
  shows.settle = std::chrono::milliseconds(static_cast<int>(options.settle_ms));
  if (is_simulated) {
    TRY_ASSIGN(SimulatedStage stage, SimulatedStage::open(options.simulated, {}));
    return simulated_rooms(std::move(shows), std::move(stage), clock);
  }
  shows.latency = std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(options.latency_ms));
  std::vector<CameraPlug> plugs;
  for (const std::string& text : options.watch) {
    TRY_ASSIGN(CameraPlug plug, parse_camera_plug(text));
    plugs.push_back(std::move(plug));
  }
  const std::filesystem::path lenses = std::filesystem::path(options.folder) / "cameras";
  return museum_rooms(std::move(shows), plugs, lenses, 1e-3 * options.watch_exposure_ms, clock);
}

HealingLoop::Options loop_options(const Options& options, CalibratorService* calibrator) {
  HealingLoop::Options wanted;
  wanted.period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / options.watch_hz));
  wanted.exposure.longest = ExposureTime(1e-3 * options.longest_exposure_ms);
  wanted.record = options.record;
  wanted.installation_file = options.simulated.empty() ? options.installation : options.simulated;
  wanted.on_line = [](const std::string& line) { log(LogLevel::kNotice, line); };
  wanted.tell = [calibrator](std::string sentence, bool is_well) { calibrator->also(std::move(sentence), is_well); };
  return wanted;
}

Status run_again(const std::filesystem::path& folder) {
  TRY_ASSIGN(const std::string lines, replay(folder));
  std::fputs(lines.c_str(), stdout);
  constexpr std::size_t kMostBytes = std::size_t{1} << 28;
  TRY_ASSIGN(const std::string recorded, read_text_file(folder / "report.txt", kMostBytes));
  if (lines == recorded) return Done{};
  return Error(ErrorCode::kBadData, "what is found now is not what was found then; see report.txt");
}

Status run(const Options& options, const StopSignal& stop) {
  if (!options.replay.empty()) return run_again(options.replay);
  const SteadyClock clock;
  Installation installation;
  DeviceOpener opener;
  TurnplateDesk desk;
  if (!options.simulated.empty()) {
    TRY_ASSIGN(SimulatedMuseum museum, SimulatedMuseum::open(options.simulated));
    installation = museum.installation();
    opener = simulated_opener(options, std::make_shared<SimulatedMuseum>(std::move(museum)));
  } else if (!options.installation.empty()) {
    TRY_ASSIGN(installation, read_installation(options.installation));
    TRY_ASSIGN(opener, real_opener(options, installation, &desk, clock));
  } else {
    return Error(ErrorCode::kInvalidArgument, "no room is named; give --installation FILE, or --simulated FILE");
  }
  InspectionService inspection("calibrator");
  CalibratorService calibrator(installation, options.folder, std::move(opener), clock, &inspection);
  calibrator.ask_at(&desk);
  TRY_ASSIGN(std::unique_ptr<ShowRooms> rooms, rooms_of(options, installation, clock));
  std::unique_ptr<HealingLoop> loop;
  if (rooms != nullptr) {
    loop = std::make_unique<HealingLoop>(std::move(installation), options.folder, std::move(rooms), clock, &inspection,
                                         loop_options(options, &calibrator));
    calibrator.hold_with([&loop]() -> std::shared_ptr<void> { return loop->hold(); });
  }
  HealingService healing(loop.get());
  TRY_ASSIGN(const std::unique_ptr<WireServer> server,
             WireServer::start(options.listen, {&calibrator, &inspection, &healing}));
  Notify notify;
  notify.ready();
  log(LogLevel::kNotice, fmt::format("waits to be told to calibrate, at port {}", server->port()));
  std::string shown;
  do {
    notify.keep_alive(clock.now());
    const std::string state = calibrator.state();
    notify.status(state);
    // Percents change all the time; what is worth a line is another situation.
    const std::string situation = state.substr(0, state.find_first_of(",;"));
    if (situation == shown) continue;
    log(LogLevel::kInfo, state);
    shown = situation;
  } while (!stop.wait_until(clock.now() + kSupervisePeriod));
  notify.stopping();
  calibrator.stop();
  healing.stop();
  server->stop(std::chrono::seconds(5));  // A photograph may take a second, and the patterns have to go.
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-calibrator",
                             "Measures the wall with a camera on a turn-plate when it is told to, writes "
                             "calibration.json, and keeps projectors in their places while the show goes on.");
  cyclorama::Options options;
  cyclorama::add_options(program.options(), &options);
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) { return cyclorama::run(options, stop); });
}
