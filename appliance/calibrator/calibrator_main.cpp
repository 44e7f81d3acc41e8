// SPDX-License-Identifier: Apache-2.0
/// cyclorama-calibrator: calibrates the wall on request, and keeps the calibration correct during the show.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibrator/calibrator_service.h"
#include "appliance/calibrator/calibrator_settings.h"
#include "appliance/healing/healing_service.h"
#include "appliance/healing/show_rooms.h"
#include "appliance/scan/frame_scan_camera.h"
#include "appliance/scan/known_lens.h"
#include "appliance/scan/remote_pattern_screen.h"
#include "appliance/scan/simulated_devices.h"
#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "drivers/devices/camera_spec.h"
#include "drivers/devices/make_camera.h"
#include "drivers/devices/make_turntable.h"
#include "drivers/simulated/turntable/simulated_turntable.h"

namespace cyclorama::calibrator {
namespace {

constexpr Duration kSupervisePeriod = std::chrono::milliseconds(500);
constexpr double kFirstExposure_s = 1.0 / 60.0;
/// Approximate width at which heads' pictures are compared with camera pictures.
constexpr double kWatchedWidth_px = 960.0;

/// Options of the command line; each overrides the settings file.
struct Options {
  std::string config;
  std::string installation;
  std::string simulated;
  std::string folder = "/var/lib/cyclorama/calibration";
  std::optional<std::string> listen;
  std::optional<std::string> camera;
  std::optional<std::string> turntable;
  std::vector<std::string> displays;
  std::optional<std::string> lens;
  std::optional<double> field_of_view_deg;
  std::optional<double> pitch_deg;
  std::optional<double> settle_ms;
  std::optional<double> max_exposure_ms;
  std::vector<std::string> watch;
  std::optional<double> watch_exposure_ms;
  std::optional<double> watch_hz;
  std::optional<double> latency_ms;
  std::string record;
  std::string replay;
  bool is_check = false;
};

CLI::Range within(const Range& range) { return {range.min, range.max}; }

void add_file_options(CLI::App& app, Options* ret) {
  app.add_option("--config", ret->config,
                 "Settings (calibrator.toml), which the options below override; without it calibrator.toml beside "
                 "installation.toml, where there is one")
      ->type_name("FILE");
  app.add_option("--installation", ret->installation, "What stands in the room (installation.toml)")->type_name("FILE");
  app.add_option(
         "--simulated", ret->simulated,
         "Calibrate a simulated museum in this process instead of the room: its installation.toml, beside which "
         "lies its truth")
      ->type_name("FILE")
      ->excludes("--installation");
  app.add_option("--folder", ret->folder, "Folder of calibration.json and of earlier calibrations")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_flag("--check", ret->is_check,
               "Read the settings and all files that they name, and end: 0 if it would start");
}

void add_scan_options(CLI::App& app, Options* ret) {
  using Ranges = CalibratorRanges;
  app.add_option("--listen", ret->listen,
                 "Address for calibration requests, and for live state to the operator; [::1]:7410")
      ->type_name("HOST:PORT");
  app.add_option("--camera", ret->camera,
                 "Camera on the turntable: v4l2:PORT[?OPTIONS], libcamera:ID[?OPTIONS]; the first one found")
      ->type_name("CAMERA");
  app.add_option("--turntable", ret->turntable,
                 "Turntable: serial:DEVICE[?OPTIONS], or manual (default), which asks a person to turn it")
      ->type_name("TURNTABLE");
  add_renamed_option(app, "--turnplate", "--turntable");
  app.add_option("--display", ret->displays,
                 "A display that shows the patterns; repeat it for several displays, with the names of their "
                 "projectors; [::1]:7404")
      ->type_name("[NAMES=]HOST:PORT")
      ->allow_extra_args(false);
  app.add_option(
         "--lens", ret->lens,
         "Lens file of this camera from 'cyclorama calibrate-camera'; without it, camera.json in FOLDER if that "
         "belongs to this camera")
      ->type_name("FILE");
  app.add_option("--field-of-view-deg", ret->field_of_view_deg,
                 "Horizontal field of view of the camera if its lens is unknown; 70")
      ->check(within(Ranges::kFieldOfView_deg));
  app.add_option("--pitch-deg", ret->pitch_deg, "Approximate upward tilt of the camera; 0")
      ->check(within(Ranges::kPitch_deg));
  app.add_option("--settle-ms", ret->settle_ms, "Delay from a projector's signal to its light; 100")
      ->check(within(Ranges::kSettle_ms));
  app.add_option("--max-exposure-ms", ret->max_exposure_ms, "Longest exposure of the camera; 250")
      ->check(within(Ranges::kMaxExposure_ms));
  add_renamed_option(app, "--longest-exposure-ms", "--max-exposure-ms");
}

void add_watch_options(CLI::App& app, Options* ret) {
  using Ranges = CalibratorRanges;
  app.add_option(
         "--watch", ret->watch,
         "A fixed camera that watches the show, by which projectors are kept aligned; its lens is FOLDER/cameras/"
         "NAME.json, or cameras/NAME.json beside calibrator.toml. Repeat it for each; they replace the file's. "
         "With --simulated and --display there is one beside each projector")
      ->type_name("NAME=CAMERA")
      ->allow_extra_args(false);
  app.add_option("--watch-exposure-ms", ret->watch_exposure_ms,
                 "Exposure of the fixed cameras: whole refreshes of projectors; 33.3")
      ->check(within(Ranges::kWatchExposure_ms));
  app.add_option("--watch-hz", ret->watch_hz, "How often their pictures are compared with the show; 4")
      ->check(within(Ranges::kWatch_hz));
  app.add_option("--latency-ms", ret->latency_ms, "Delay from a refresh of the display to the projector's light; 30")
      ->check(within(Ranges::kLatency_ms));
  app.add_option("--record", ret->record,
                 "Keep what is shown and seen in FOLDER/TIME for --replay; FOLDER grows to 8 GiB")
      ->type_name("FOLDER");
  app.add_option("--replay", ret->replay,
                 "Only compute the corrections of a record again, print them, and exit: 0 if they are the same")
      ->type_name("FOLDER");
}

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kReadByEye_rad = 0.3 * kDegree;  // Error of a scale with whole degrees that is read by eye.

constexpr double kMillisecond = 1e-3;
constexpr const char* kOwnDisplay = "[::1]:7404";

/// Returns the settings file; empty if there is none.
std::filesystem::path config_of(const Options& options) {
  if (!options.config.empty() || options.installation.empty()) return options.config;
  const auto beside = std::filesystem::path(options.installation).parent_path() / "calibrator.toml";
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside : std::filesystem::path();
}

Result<CalibratorSettings> settings_of(const Options& options) {
  CalibratorSettings settings;
  if (const auto config = config_of(options); !config.empty()) {
    TRY_ASSIGN(settings, CalibratorSettings::read(config));
  }
  if (options.listen) settings.listen = *options.listen;
  if (options.camera) settings.camera = *options.camera;
  if (options.turntable) settings.turntable = *options.turntable;
  if (!options.displays.empty()) settings.displays.clear();
  for (const std::string& text : options.displays) {
    TRY_ASSIGN(scan::PatternDisplay display, scan::parse_pattern_display(text));
    settings.displays.push_back(std::move(display));
  }
  // A museum that is simulated as a whole has no display.
  if (settings.displays.empty() && options.simulated.empty()) settings.displays.push_back({kOwnDisplay});
  if (options.lens) settings.lens = *options.lens;
  if (options.field_of_view_deg) settings.field_of_view_rad = kDegree * *options.field_of_view_deg;
  if (options.pitch_deg) settings.pitch_rad = kDegree * *options.pitch_deg;
  if (options.settle_ms) settings.settle_s = kMillisecond * *options.settle_ms;
  if (options.max_exposure_ms) settings.max_exposure_s = kMillisecond * *options.max_exposure_ms;
  if (!options.watch.empty()) settings.watch.clear();
  for (const std::string& text : options.watch) {
    TRY_ASSIGN(scan::CameraSource plug, scan::parse_camera_source(text));
    settings.watch.push_back(std::move(plug));
  }
  if (options.watch_exposure_ms) settings.watch_exposure_s = kMillisecond * *options.watch_exposure_ms;
  if (options.watch_hz) settings.watch_hz = *options.watch_hz;
  if (options.latency_ms) settings.latency_s = kMillisecond * *options.latency_ms;
  return settings;
}

/// Returns the folders that are searched for the lenses of fixed cameras.
std::vector<std::filesystem::path> lens_folders(const Options& options, const CalibratorSettings& settings) {
  std::vector<std::filesystem::path> folders{std::filesystem::path(options.folder) / "cameras"};
  if (!settings.lenses.empty()) folders.push_back(settings.lenses);
  return folders;
}

/// Carries out --check: finds problems in the files that would prevent a start or a calibration.
Status check(const Options& options, const CalibratorSettings& settings) {
  TRY(settings.check_lenses());
  if (options.installation.empty()) return Done{};
  TRY_ASSIGN(const Installation installation, read_installation(options.installation));
  for (const InstalledProjector& projector : installation.projectors) {
    TRY(scan::display_of(projector.name, settings.displays));
  }
  return Done{};
}

Result<scan::ScanSettings> scan_settings(const CalibratorSettings& settings, const std::filesystem::path& folder,
                                         const scan::ScanCamera& camera) {
  scan::ScanSettings scan;
  TRY_ASSIGN(const std::optional<calibration::MeasuredLens> known,
             scan::known_lens(settings.lens, folder, camera.id(), camera.width_px(), camera.height_px()));
  scan.camera =
      known ? *known : scan::data_sheet_lens(camera.width_px(), camera.height_px(), settings.field_of_view_rad);
  scan.pitch_rad = settings.pitch_rad;
  scan.view.exposure.longest = structured_light::ExposureTime(settings.max_exposure_s);
  return scan;
}

std::chrono::milliseconds settle_of(const CalibratorSettings& settings) {
  return std::chrono::milliseconds(static_cast<int>(1e3 * settings.settle_s + 0.5));
}

/// Returns an opener of simulated devices. It shares ownership of the museum, which must outlive all devices.
DeviceOpener simulated_opener(const CalibratorSettings& settings, const std::filesystem::path& folder,
                              std::shared_ptr<simulated::SimulatedMuseum> museum) {
  return [settings, folder, museum]() -> Result<CalibrationDevices> {
    CalibrationDevices devices;
    devices.turntable = std::make_unique<simulated::SimulatedTurntable>(museum.get());
    devices.camera = std::make_unique<scan::SimulatedScanCamera>(museum.get(), scan::PhotographColour::kGrey);
    devices.colour_camera = std::make_unique<scan::SimulatedScanCamera>(museum.get(), scan::PhotographColour::kColour);
    devices.screen = std::make_unique<scan::SimulatedPatternScreen>(museum.get());
    TRY_ASSIGN(devices.settings, scan_settings(settings, folder, *devices.camera));
    return devices;
  };
}

/// Returns the operator of a manual turntable: a calibrator in a terminal prompts there; a service passes questions to
/// the client that requested the calibration.
std::unique_ptr<turntable::TurntableOperator> operator_at(TurntablePrompt* prompt) {
  if (::isatty(STDIN_FILENO) == 1) return std::make_unique<turntable::TerminalOperator>(STDIN_FILENO, STDERR_FILENO);
  return std::make_unique<PromptOperator>(prompt);
}

DeviceOpener real_opener(const CalibratorSettings& settings, const std::filesystem::path& folder,
                         const Installation& installation, TurntablePrompt* prompt, const Clock& clock) {
  return [settings, folder, projectors = installation.projectors, prompt, &clock]() -> Result<CalibrationDevices> {
    const scan::FrameScanCamera::Opener open_camera = [spec = settings.camera, &clock](double exposure_s) {
      // The gain must be fixed, so that photographs are comparable; libcamera's cameras fix it together with the
      // exposure.
      const std::string_view held = spec.starts_with("v4l2:") ? "&gain=held" : "";
      // The rate follows the exposure, since cameras shorten an exposure that exceeds the frame period.
      const double rate_hz = std::min(30.0, 0.9 / exposure_s);
      return devices::make_camera(
          devices::with_defaults(spec, fmt::format("{}&frames_per_second={:.4g}&colour=yes&exposure_ms={}{}",
                                                   devices::kCalibrationSize, rate_hz, 1e3 * exposure_s, held)),
          clock);
    };
    CalibrationDevices devices;
    TRY_ASSIGN(devices.turntable, devices::make_turntable(settings.turntable, operator_at(prompt)));
    TRY_ASSIGN(devices.camera, scan::FrameScanCamera::open(open_camera, kFirstExposure_s, clock));
    TRY_ASSIGN(devices.screen, scan::RemotePatternScreen::open(projectors, settings.displays, settle_of(settings)));
    TRY_ASSIGN(devices.settings, scan_settings(settings, folder, *devices.camera));
    if (settings.turntable == "manual") devices.settings.turntable_sigma_rad = kReadByEye_rad;
    return devices;
  };
}

Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

/// Returns the rooms for the continuous calibration; null if no camera watches.
Result<std::unique_ptr<healing::ShowRooms>> rooms_of(const Options& options, const CalibratorSettings& settings,
                                                     const Installation& installation, const Clock& clock) {
  const bool is_simulated = !options.simulated.empty() && !settings.displays.empty();
  if (!is_simulated && settings.watch.empty()) return std::unique_ptr<healing::ShowRooms>();
  if (!options.simulated.empty() && !settings.watch.empty()) {
    return Error(ErrorCode::kInvalidArgument, "a simulated museum has cameras of its own; leave out --watch");
  }
  healing::ShowDisplays shows;
  shows.projectors = installation.projectors;
  shows.displays = settings.displays;
  const auto widest = std::ranges::max(installation.projectors, {}, [](const auto& p) { return p.lens.width_px; });
  shows.factor = std::max(1, static_cast<int>(std::lround(widest.lens.width_px / kWatchedWidth_px)));
  shows.settle = settle_of(settings);
  if (is_simulated) {
    TRY_ASSIGN(simulated::SimulatedStage stage, simulated::SimulatedStage::open(options.simulated, {}));
    return healing::simulated_rooms(std::move(shows), std::move(stage), clock);
  }
  shows.latency = seconds(settings.latency_s);
  return healing::museum_rooms(std::move(shows), settings.watch, lens_folders(options, settings),
                               settings.watch_exposure_s, clock);
}

healing::HealingLoop::Options loop_options(const Options& options, const CalibratorSettings& settings,
                                           CalibratorService* calibrator) {
  healing::HealingLoop::Options wanted;
  wanted.period = seconds(1.0 / settings.watch_hz);
  wanted.exposure.longest = structured_light::ExposureTime(settings.max_exposure_s);
  wanted.record = options.record;
  wanted.installation_file = options.simulated.empty() ? options.installation : options.simulated;
  wanted.on_line = [](const std::string& line) { log(LogLevel::kNotice, line); };
  wanted.tell = [calibrator](std::string sentence, bool is_well) { calibrator->also(std::move(sentence), is_well); };
  return wanted;
}

Status run_again(const std::filesystem::path& folder) {
  TRY_ASSIGN(const std::string lines, healing::replay(folder));
  std::fputs(lines.c_str(), stdout);
  constexpr std::size_t kMaxBytes = std::size_t{1} << 28;
  TRY_ASSIGN(const std::string recorded, read_text_file(folder / "report.txt", kMaxBytes));
  if (lines == recorded) return Done{};
  return Error(ErrorCode::kBadData, "the corrections are not the recorded ones; see report.txt");
}

Status run(const Options& options, const StopSignal& stop) {
  if (!options.replay.empty()) return run_again(options.replay);
  TRY_ASSIGN(const CalibratorSettings settings, settings_of(options));
  if (options.is_check) return check(options, settings);
  const SteadyClock clock;
  Installation installation;
  DeviceOpener opener;
  TurntablePrompt prompt;
  if (!options.simulated.empty()) {
    TRY_ASSIGN(simulated::SimulatedMuseum museum, simulated::SimulatedMuseum::open(options.simulated));
    installation = museum.installation();
    opener =
        simulated_opener(settings, options.folder, std::make_shared<simulated::SimulatedMuseum>(std::move(museum)));
  } else if (!options.installation.empty()) {
    TRY_ASSIGN(installation, read_installation(options.installation));
    opener = real_opener(settings, options.folder, installation, &prompt, clock);
  } else {
    return Error(ErrorCode::kInvalidArgument, "no room is named; give --installation FILE, or --simulated FILE");
  }
  InspectionService inspection("calibrator");
  CalibratorService calibrator(installation, options.folder, std::move(opener), clock, &inspection);
  calibrator.set_prompt(&prompt);
  TRY_ASSIGN(std::unique_ptr<healing::ShowRooms> rooms, rooms_of(options, settings, installation, clock));
  std::unique_ptr<healing::HealingLoop> loop;
  if (rooms != nullptr) {
    loop = std::make_unique<healing::HealingLoop>(std::move(installation), options.folder, std::move(rooms), clock,
                                                  &inspection, loop_options(options, settings, &calibrator));
    calibrator.hold_with([&loop]() -> std::shared_ptr<void> { return loop->hold(); });
  }
  healing::HealingService healing(loop.get());
  TRY_ASSIGN(const std::unique_ptr<WireServer> server,
             WireServer::start(settings.listen, {&calibrator, &inspection, &healing}));
  Notify notify;
  notify.ready();
  log(LogLevel::kNotice, fmt::format("waits for calibration requests at port {}", server->port()));
  std::string shown;
  do {
    // Without this the watchdog restarts the process, which is the remedy for a camera or display that hangs.
    if (calibrator.moves_on() && (loop == nullptr || loop->moves_on())) notify.keep_alive(clock.now());
    const std::string state = calibrator.state();
    notify.status(state);
    // Percentages change all the time; a line is logged only if the situation changes.
    const std::string situation = state.substr(0, state.find_first_of(",;"));
    if (situation == shown) continue;
    log(LogLevel::kInfo, state);
    shown = situation;
  } while (!stop.wait_until(clock.now() + kSupervisePeriod));
  notify.stopping();
  calibrator.stop();
  healing.stop();
  // A photograph may take a second, and the patterns must be removed from the wall.
  server->stop(std::chrono::seconds(5));
  return Done{};
}

}  // namespace
}  // namespace cyclorama::calibrator

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-calibrator",
                             "Calibrates the wall on request with a camera on a turntable, writes "
                             "calibration.json, and keeps projectors aligned during the show.");
  cyclorama::calibrator::Options options;
  cyclorama::calibrator::add_file_options(program.options(), &options);
  cyclorama::calibrator::add_scan_options(program.options(), &options);
  cyclorama::calibrator::add_watch_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::calibrator::run(options, stop); });
}
