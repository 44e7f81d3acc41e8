// SPDX-License-Identifier: Apache-2.0
/// cyclorama-tour: leads the visit.
#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "kiosk/tour/session/tour.h"
#include "kiosk/tour/session/tour_service.h"

namespace cyclorama {
namespace {

struct Options {
  std::string listen = "[::1]:7403";
  std::optional<std::string> config;
  std::vector<std::string> farms;
  std::optional<std::string> scene;
  std::optional<double> budget_ms;
  std::optional<int> samples;
  std::optional<int> quality;
  std::optional<double> guard_deg;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--listen", options->listen, "Address for displays, trackers and the operator")->capture_default_str();
  app.add_option("--config", options->config, "The museum's site.toml: [farm], [picture], [walk]");
  app.add_option("--farm", options->farms, "Address of the farm's head; repeat it for a second one to turn to")
      ->allow_extra_args(false);
  app.add_option("--scene", options->scene, "Name of the scene to visit; else the farm's first");
  CLI::Option* const budget =
      app.add_option(
             "--budget-ms", options->budget_ms,
             "Time per frame that the farm holds while the view moves, by its choice of the quality (default 50)")
          ->check(CLI::Range(1.0, 60000.0));
  app.add_option("--samples", options->samples, "Rays per pixel, always as many, instead of a budget")
      ->check(CLI::Range(1, 4096))
      ->excludes(budget);
  app.add_option("--quality", options->quality, "JPEG quality of the tiles, always the same, instead of a budget")
      ->check(CLI::Range(1, 100))
      ->excludes(budget);
  app.add_option("--guard-deg", options->guard_deg, "Degrees rendered beyond each side of the wall, for quick turns")
      ->check(CLI::Range(0.0, 90.0));
}

Result<TourSettings> settings_of(const Options& options) {
  TourSettings settings = default_tour_settings();
  if (options.config) {
    TRY_ASSIGN(settings, read_tour_settings(*options.config));
  }
  if (!options.farms.empty()) settings.heads = options.farms;
  if (options.scene) settings.scene = *options.scene;
  if (options.samples || options.quality) settings.picture.frame_budget_ms = 0.0;
  if (options.budget_ms) settings.picture.frame_budget_ms = *options.budget_ms;
  if (options.samples) settings.picture.samples = *options.samples;
  if (options.quality) settings.picture.jpeg_quality = *options.quality;
  if (options.guard_deg) settings.picture.guard_rad = *options.guard_deg * std::numbers::pi / 180.0;
  return settings;
}

Status run(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(TourSettings settings, settings_of(options));
  InspectionService inspection("tour");
  TRY_ASSIGN(const std::unique_ptr<Tour> tour, Tour::start(std::move(settings), &inspection));
  TourService service(tour->displays(), tour.get());
  TRY_ASSIGN(const std::unique_ptr<WireServer> server, WireServer::start(options.listen, {&service, &inspection}));
  log(LogLevel::kNotice, fmt::format("the tour listens on {} (port {})", options.listen, server->port()));
  Notify notify;
  notify.ready();
  std::uint64_t rounds = 0;
  while (!stop.wait_until(SteadyClock().now() + std::chrono::seconds(1))) {
    if (tour->rounds() != rounds) notify.keep_alive(SteadyClock().now());
    rounds = tour->rounds();
    notify.status(inspection.status().state());
  }
  notify.stopping();
  tour->stop();
  server->stop(std::chrono::milliseconds(500));
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-tour",
                             "Leads the visit: follows the pattern or the keys, asks the farm for "
                             "pictures, and feeds the displays.");
  cyclorama::Options options;
  cyclorama::add_options(program.options(), &options);
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) { return cyclorama::run(options, stop); });
}
