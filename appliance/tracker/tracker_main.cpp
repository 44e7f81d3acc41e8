// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "appliance/tracker/tracker.h"
#include "appliance/tracker/tracker_settings.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "drivers/devices/make_camera.h"

namespace cyclorama::tracker {
namespace {

constexpr Duration kSupervisePeriod = std::chrono::milliseconds(500);

/// Options of the command line; each overrides the settings file.
struct Options {
  std::string config;
  std::optional<std::string> camera;
  std::optional<std::string> tour;
  std::optional<std::string> listen;
  std::optional<std::string> osc;
  std::optional<std::string> vrpn;
  std::optional<std::string> steer_by;
  std::optional<double> mark_distance_m;
  std::optional<double> tag_size_mm;
  std::vector<std::string> wands;
  std::optional<double> field_of_view_deg;
  std::optional<double> decimate;
  bool list_cameras = false;
  bool is_check = false;
};

void add_options(CLI::App* app, Options* ret) {
  app->add_option("--config", ret->config, "Settings (tracker.toml); without it the defaults hold")->type_name("FILE");
  app->add_option("--camera", ret->camera,
                  "v4l2:PORT[?width_px=N&height_px=N&frames_per_second=N&exposure_ms=N], libcamera:ID[?...], "
                  "file:PATH[?frames_per_second=N&loop=no] or simulated[:FILE.toml]")
      ->type_name("CAMERA");
  app->add_option("--tour", ret->tour, "Where the tour listens")->type_name("HOST:PORT");
  app->add_option("--listen", ret->listen, "Where to show live state to the operator")->type_name("HOST:PORT");
  app->add_option("--osc", ret->osc, "Send each pose here as well, as Open Sound Control")->type_name("HOST:PORT");
  app->add_option("--vrpn", ret->vrpn, "Send each pose here as well, as VRPN's datagrams")->type_name("HOST:PORT");
  app->add_option("--steer-by", ret->steer_by,
                  "wand (default), or body: visitors carry nothing, and stand at a mark; leaning turns, stepping walks")
      ->check(CLI::IsMember({"wand", "body"}));
  app->add_option("--mark-distance-m", ret->mark_distance_m,
                  "With --steer-by body: distance from the camera to the mark; 2 m")
      ->check(CLI::Range(0.5, 10.0));
  app->add_option("--tag-size-mm", ret->tag_size_mm, "Follow flat tags instead of wands: edge of the black square")
      ->check(CLI::Range(1.0, 10000.0));
  app->add_option("--wand", ret->wands, "Follow the wand that FILE describes (cyclorama wand --describe); repeat it")
      ->type_name("FILE")
      ->allow_extra_args(false);
  app->add_option("--field-of-view-deg", ret->field_of_view_deg, "Horizontal field of view of the camera")
      ->check(CLI::Range(1.0, 170.0));
  app->add_option("--decimate", ret->decimate, "Seek tags in a picture this many times smaller")
      ->check(CLI::Range(1.0, 8.0));
  app->add_flag("--check", ret->is_check,
                "Read the settings and all files that they name, and end: 0 if it would start");
  app->add_flag("--list-cameras", ret->list_cameras,
                "List the cameras that are plugged in, each with its lines for tracker.toml, and end");
}

/// Prints, for each camera, a block that can be pasted into tracker.toml.
void print_cameras() {
  const std::vector<camera::ListedCamera> cameras = devices::list_cameras();
  if (cameras.empty()) fmt::print("# No camera is plugged in, or none that the kernel or libcamera drives.\n");
  for (const camera::ListedCamera& camera : cameras) {
    fmt::print("# {}{}{}\n", camera.name, camera.name.empty() ? "" : ", now ", camera.path);
    if (!camera.sends.empty()) fmt::print("# sends {}\n", camera.sends);
    if (!camera.problem.empty()) fmt::print("# cannot be used: {}\n", camera.problem);
    const std::string kind = camera.spec.substr(0, camera.spec.find(':'));
    const std::string device = camera.spec.substr(kind.size() + 1);
    const bool is_path = kind == "v4l2" && device.starts_with("/");
    fmt::print("[camera]\nkind = \"{}\"\n{} = \"{}\"\n\n", kind, is_path ? "device" : "port", device);
  }
}

Result<TrackerSettings> settings_of(const Options& options) {
  TrackerSettings settings;
  if (!options.config.empty()) {
    TRY_ASSIGN(settings, TrackerSettings::read(options.config));
  }
  if (options.camera) settings.camera = *options.camera;
  if (options.tour) settings.tour = *options.tour;
  if (options.listen) settings.listen = *options.listen;
  if (options.osc) settings.osc = *options.osc;
  if (options.vrpn) settings.vrpn = *options.vrpn;
  if (options.steer_by) settings.steer_by = *options.steer_by == "body" ? SteerBy::kBody : SteerBy::kWand;
  if (options.mark_distance_m) settings.body.mark_distance_m = *options.mark_distance_m;
  PatternSettings& patterns = settings.tracking.patterns;
  if (options.tag_size_mm) patterns.flat_tag_size_m = 1e-3 * *options.tag_size_mm;
  if (!options.wands.empty()) patterns = {};
  for (const std::string& file : options.wands) {
    TRY_ASSIGN(Wand wand, read_wand(file));
    patterns.wands.push_back(std::move(wand));
  }
  if (options.field_of_view_deg) {
    settings.lens.field_of_view_rad = *options.field_of_view_deg * std::numbers::pi / 180.0;
    settings.lens.focal_px.reset();
  }
  if (options.decimate) settings.detector.decimate = *options.decimate;
  return settings;
}

Status run(const Options& options, const StopSignal& stop) {
  if (options.list_cameras) {
    print_cameras();
    return Done{};
  }
  TRY_ASSIGN(const TrackerSettings settings, settings_of(options));
  if (options.is_check) return Done{};
  const SteadyClock clock;
  InspectionService inspection("tracker");
  TRY_ASSIGN(const std::unique_ptr<WireServer> server, WireServer::start(settings.listen, {&inspection}));
  TRY_ASSIGN(const std::unique_ptr<Tracker> tracker, Tracker::start(settings, clock, &inspection));
  Notify notify;
  notify.ready();
  log(LogLevel::kNotice,
      fmt::format("tracks '{}' for the tour at {}; state at port {}", settings.camera, settings.tour, server->port()));
  std::string shown;
  do {
    if (tracker->supervise()) notify.keep_alive(clock.now());
    // The rate changes all the time, so only a changed situation is logged.
    const std::string situation = tracker->state().substr(0, tracker->state().find(','));
    if (situation != shown) {
      notify.status(tracker->state());
      log(LogLevel::kInfo, tracker->state());
      shown = situation;
    }
  } while (!stop.wait_until(clock.now() + kSupervisePeriod));
  notify.stopping();
  server->stop(std::chrono::milliseconds(200));
  return Done{};
}

}  // namespace
}  // namespace cyclorama::tracker

int main(int argc, char** argv) {
  cyclorama::Program program(
      "cyclorama-tracker",
      "Finds the visitor's wand, or the visitor, in a camera's pictures and sends the pose to the tour.");
  cyclorama::tracker::Options options;
  add_options(&program.options(), &options);
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) { return run(options, stop); });
}
