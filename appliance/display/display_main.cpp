// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "appliance/display/attract_picture.h"
#include "appliance/display/calibrated_heads.h"
#include "appliance/display/display.h"
#include "appliance/display/display_settings.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"

namespace cyclorama::display {
namespace {

// Timeout for one step of the start. A busy, emulated processor needs almost a minute to compile a shader.
constexpr auto kStartStepTimeout = std::chrono::minutes(3);
// Most projectors support this rate; others take the nearest rate that they support.
constexpr double kProjectors_hz = 60.0;
constexpr auto kTurn = std::chrono::milliseconds(100);  // Maximum delay until a stop is noticed.

struct Options {
  std::string config;
  std::string installation;
  std::string output = "headless";
  std::vector<std::string> heads;
  bool is_check = false;
  std::optional<int> width_px;
  std::optional<int> height_px;
  std::optional<double> refresh_hz;
  DisplayOptions display;
};

void add_options(CLI::App* app, Options* options) {
  DisplayOptions& display = options->display;
  app->add_option("--installation", options->installation, "The room: wall, sweet spot and projectors (TOML)")
      ->required();
  app->add_option("--config", options->config, "The museum's site.toml: [display], [hours]");
  app->add_option("--hours-override", display.hours_override,
                  "File in which the operator page keeps its override of [hours] for one day");
  app->add_option("--reach", display.reach,
                  "File in which the operator page writes how it is reached: the wall shows it until there is a PIN, "
                  "after Help, and when the page was not reachable for a day");
  app->add_option("--help-pressed", display.help_pressed, "File that cyclorama-hand writes when Help is pressed");
  app->add_option("--tour", display.tour, "HOST:PORT of the tour to show, such as [::1]:7403")->required();
  app->add_option("--listen", display.listen,
                  "HOST:PORT for inspection and a calibration's patterns; port 0 takes a free one")
      ->capture_default_str();
  app->add_option("--run-dir", display.output.run_dir,
                  "Publish what each head shows as head-NAME.picture in this folder");
  app->add_flag("--check", options->is_check,
                "Read the settings and all files that they name, and end: 0 if it would start");
  app->add_option("--width", options->width_px, "Width in pixels of the requested picture. Overrides site.toml")
      ->check(CLI::Range(16, 16384));
  app->add_option("--height", options->height_px, "Its height; 0 for square pixels. Overrides site.toml")
      ->check(CLI::Range(0, 16384));
  app->add_option("--refresh-hz", options->refresh_hz, "Refreshes per second. Overrides site.toml")
      ->check(CLI::Range(0.1, 1000.0));
  app->add_option("--output", options->output,
                  "Where to draw: drm (the projectors), headless (EGL, else OSMesa), egl or osmesa")
      ->check(CLI::IsMember({"drm", "headless", "egl", "osmesa"}))
      ->capture_default_str();
  app->add_option(
      "--head", options->heads,
      "With drm: PROJECTOR=CONNECTOR, such as left=HDMI-A-1; 1:HDMI-A-1 is on the second card; ,90 (180, 270) "
      "turns the picture clockwise. Overrides the installation's connector, card and turn_deg; projectors that are "
      "not named take the free connectors");
  app->add_option(
      "--card", display.output.cards,
      "With drm: the graphics cards, such as /dev/dri/card0; the first one draws. Overrides the installation's "
      "cards; without either: all cards");
  app->add_option("--calibration", display.calibration,
                  "A calibration's folder: draw as it measured, and change over when it is replaced. Overrides "
                  "site.toml");
  app->add_option("--decode-threads", display.decode_threads, "Threads that decode tiles")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
}

/// Logs when the process becomes healthy or unhealthy, once it has had time to connect to its tour.
class StateLog {
 public:
  void see(const wire::ProcessStatus& status) {
    if (status.healthy() == was_healthy_ || (!status.healthy() && status.uptime_s() < kTimeToConnect_s)) return;
    was_healthy_ = status.healthy();
    log(was_healthy_ ? LogLevel::kInfo : LogLevel::kWarning, status.state());
  }

 private:
  static constexpr double kTimeToConnect_s = 30.0;
  bool was_healthy_ = true;
};

/// Reads the files that the start requires. A broken calibration does not prevent the start.
Status check(const DisplayOptions& display) {
  const Projection picture = display.installation.projection(display.width_px, display.height_px);
  TRY(picture.validate());
  TRY(planned_heads(display.installation, picture.shape));
  if (!display.attract_picture.empty()) TRY(attract_frame(picture.shape, display.attract_picture));
  return Done{};
}

Status run_display(Options options, const StopSignal& stop) {
  TRY_ASSIGN(options.display.installation, read_installation(options.installation));
  OutputChoice& output = options.display.output;
  if (options.output == "drm") output.kind = OutputChoice::Kind::kDrm;
  if (options.output == "egl") output.renderer = output::HeadlessOptions::Renderer::kEgl;
  if (options.output == "osmesa") output.renderer = output::HeadlessOptions::Renderer::kOsMesa;
  for (const std::string& head : options.heads) {
    TRY_ASSIGN(OutputChoice::Head parsed, parse_head(head));
    output.heads.push_back(std::move(parsed));
  }
  DisplaySettings settings;
  if (!options.config.empty()) {
    TRY_ASSIGN(settings, read_display_settings(options.config));
  }
  options.display.attract_picture = settings.attract_picture;
  options.display.attract_times = settings.attract_times;
  options.display.hours = settings.hours;
  options.display.width_px = options.width_px.value_or(settings.picture_width_px);
  options.display.height_px = options.height_px.value_or(settings.picture_height_px);
  if (output.kind == OutputChoice::Kind::kDrm) options.display.refresh_hz = kProjectors_hz;
  options.display.refresh_hz = options.refresh_hz.value_or(settings.refresh_hz.value_or(options.display.refresh_hz));
  if (options.display.calibration.empty()) options.display.calibration = settings.calibration;
  if (options.is_check) return check(options.display);
  const SteadyClock clock;
  const std::string tour = options.display.tour;
  Notify notify;
  options.display.on_start_step = [&notify] { notify.starting(kStartStepTimeout); };
  TRY_ASSIGN(const std::unique_ptr<Display> display, Display::start(std::move(options.display), clock));
  notify.ready();
  const wire::ProcessStatus first = display->inspection().status();
  for (const wire::Fact& fact : first.facts()) log(LogLevel::kDebug, fmt::format("{}: {}", fact.name(), fact.value()));
  log(LogLevel::kInfo, fmt::format("showing the tour at {}; inspection on port {}", tour, display->port()));

  StateLog state_log;
  while (!stop.requested()) {
    display->serve(clock.now() + kTurn);
    if (display->is_presenting()) notify.keep_alive(clock.now());
    state_log.see(display->inspection().status());
  }
  notify.stopping();
  return Done{};
}

}  // namespace
}  // namespace cyclorama::display

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::display;
  Program program("cyclorama-display",
                  "Shows the tour on the wall: decodes its tiles, warps and blends them for each projector.");
  Options options;
  options.display.decode_threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 4U));
  add_options(&program.options(), &options);
  return program.run(argc, argv, [&](const StopSignal& stop) { return run_display(std::move(options), stop); });
}
