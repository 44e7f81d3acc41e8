// SPDX-License-Identifier: Apache-2.0
/// cyclorama-tour: leads the visit.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/wire/channel.h"
#include "kiosk/tour/navigation/walk_record.h"
#include "kiosk/tour/session/tour.h"
#include "kiosk/tour/session/tour_service.h"

namespace cyclorama::tour {
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
  std::optional<std::string> state;
  std::optional<std::string> tour;
  std::optional<std::string> pictures;
  std::optional<std::string> record;
  std::optional<std::string> replay;
  bool is_check = false;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--listen", options->listen, "Address for displays, trackers and the operator")->capture_default_str();
  app.add_option("--config", options->config, "The museum's site.toml: [farm], [picture], [walk]");
  app.add_option("--farm", options->farms, "Address of the farm's coordinator; repeat it for a fallback")
      ->allow_extra_args(false);
  app.add_option("--scene", options->scene, "Name of the scene to visit; else the farm's first");
  CLI::Option* const budget =
      app.add_option("--budget-ms", options->budget_ms,
                     "Time per frame while the view moves; the farm chooses the quality that fits (default 50)")
          ->check(CLI::Range(1.0, 60000.0));
  app.add_option("--samples", options->samples, "Fixed number of samples per pixel, instead of a budget")
      ->check(CLI::Range(1, 4096))
      ->excludes(budget);
  app.add_option("--quality", options->quality, "Fixed JPEG quality of the tiles, instead of a budget")
      ->check(CLI::Range(1, 100))
      ->excludes(budget);
  app.add_option("--guard-deg", options->guard_deg, "Degrees rendered beyond each side of the wall, for quick turns")
      ->check(CLI::Range(0.0, 90.0));
  app.add_flag("--check", options->is_check,
               "Read the settings and all files that they name, and end: 0 if it would start");
  app.add_option("--state", options->state,
                 "Save the visitor's position in this folder, and continue there after a restart")
      ->type_name("FOLDER");
  app.add_option("--tour", options->tour,
                 "Folder of a curator's tour, where site.toml names none in [tour]; it need not exist yet")
      ->type_name("FOLDER");
  app.add_option("--pictures", options->pictures,
                 "Keep pictures of the stops in this folder, for the time when the farm is away")
      ->type_name("FOLDER");
  app.add_option("--record", options->record,
                 "Write the walk, every pose, key and step with its time, to this new file")
      ->type_name("FILE");
  app.add_option("--replay", options->replay,
                 "Replay a walk from --record without a farm, and report whether every view is the same to the bit")
      ->type_name("FILE")
      ->excludes("--record");
}

Result<TourSettings> settings_of(const Options& options) {
  TourSettings settings = default_tour_settings();
  if (options.config) {
    TRY_ASSIGN(settings, read_tour_settings(*options.config));
  }
  if (!options.farms.empty()) settings.coordinators = options.farms;
  if (options.scene) settings.scene = *options.scene;
  if (options.samples || options.quality) settings.picture.frame_budget_ms = 0.0;
  if (options.budget_ms) settings.picture.frame_budget_ms = *options.budget_ms;
  if (options.samples) settings.picture.samples = *options.samples;
  if (options.quality) settings.picture.jpeg_quality = *options.quality;
  if (options.tour && settings.tour_folder.empty()) settings.tour_folder = *options.tour;
  if (options.pictures && settings.keep_bytes > 0) settings.pictures_folder = *options.pictures;
  if (options.guard_deg) settings.picture.guard_rad = *options.guard_deg * std::numbers::pi / 180.0;
  return settings;
}

/// Errors: those of parse_tour_plan(), if the folder has a tour. Its positions are checked when a scene is open.
Status check_tour(const std::filesystem::path& folder) {
  if (folder.empty()) return Done{};
  const TourFolder tour(folder);
  const auto text = tour.read();
  if (!text && text.error().code() == ErrorCode::kNotFound) return Done{};
  if (!text) return text.error();
  TRY_ASSIGN(TourPlan plan, parse_tour_plan(*text, tour.file().string()));
  return tour.read_captions(&plan);
}

/// The file of the recorded walk. A full disk ends the recording, not the visit.
class RecordFile {
 public:
  static Result<RecordFile> open(const std::string& path) {
    RecordFile file;
    // Never overwrites a recording: somebody made it to look for a fault.
    file.file_.reset(std::fopen(path.c_str(), "wx"));
    if (file.file_ == nullptr) return Error::from_errno(fmt::format("recording to '{}'", path));
    return file;
  }
  void write(const std::string& text) {
    if (file_ == nullptr) return;
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size() && std::fflush(file_.get()) == 0) return;
    log(LogLevel::kWarning, "the recording cannot be written any further (is the disk full?), ignoring");
    file_.reset();
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

/// Saves the visitor's position. If the folder is full or gone, the position is lost but the visit continues.
class PositionFile {
 public:
  explicit PositionFile(const std::optional<std::string>& folder) {
    if (folder) path_ = saved_position_path(*folder);
  }
  /// Returns nothing when there is no file, or a damaged one.
  [[nodiscard]] std::optional<SavedPosition> read() const {
    constexpr std::size_t kMaxBytes = 64 << 10;
    if (path_.empty()) return std::nullopt;
    const auto text = read_text_file(path_, kMaxBytes);
    if (!text) return std::nullopt;
    auto position = parse_saved_position(*text, path_.string());
    if (!position) {
      log(LogLevel::kWarning, position.error().message() + ", ignoring");
      return std::nullopt;
    }
    return *std::move(position);
  }
  void write(const std::optional<SavedPosition>& position) {
    if (path_.empty() || !position || position == kept_) return;
    const Status written = write_file_atomically(path_, to_text(*position));
    if (written) {
      kept_ = position;
    } else if (!std::exchange(warned_, true)) {
      log(LogLevel::kWarning, written.error().message() + ", ignoring");
    }
  }

 private:
  std::filesystem::path path_;
  std::optional<SavedPosition> kept_;
  bool warned_ = false;
};

Status replay(const std::string& path) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
  TRY_ASSIGN(const std::string text, read_text_file(path, kMaxBytes));
  TRY_ASSIGN(const WalkRecord record, parse_walk_record(text, path));
  const WalkReplay walk = replayed(record);
  constexpr double kDegree = std::numbers::pi / 180.0;
  const ViewPeaks& peaks = walk.peaks;
  fmt::print(
      "{} views and {} pictures of {:.1f} s; {:.1f} m walked; at most {:.2f} m/s and {:.1f} deg/s, "
      "{:.2f} m/s2 and {:.0f} deg/s2\n",
      walk.ticks, walk.poses, to_seconds(walk.length), peaks.distance_m, peaks.speed_m_per_s,
      peaks.turn_rad_per_s / kDegree, peaks.acceleration_m_per_s2, peaks.turn_acceleration_rad_per_s2 / kDegree);
  if (walk.difference)
    return Error(ErrorCode::kBadData, fmt::format("the replay of '{}' differs: {}", path, *walk.difference));
  fmt::print("the same to the bit\n");
  return Done{};
}

Status run(const Options& options, const StopSignal& stop) {
  if (options.replay) return replay(*options.replay);
  TRY_ASSIGN(TourSettings settings, settings_of(options));
  if (options.is_check) return check_tour(settings.tour_folder);
  RecordFile record;
  if (options.record) {
    TRY_ASSIGN(record, RecordFile::open(*options.record));
  }
  settings.record = options.record.has_value();
  PositionFile position(options.state);
  settings.resume = position.read();
  InspectionService inspection("tour");
  TRY_ASSIGN(const std::unique_ptr<Tour> tour, Tour::start(std::move(settings), &inspection));
  TourService service(tour->displays(), tour.get(), tour.get());
  TRY_ASSIGN(const std::unique_ptr<WireServer> server, WireServer::start(options.listen, {&service, &inspection}));
  log(LogLevel::kNotice, fmt::format("the tour listens on {} (port {})", options.listen, server->port()));
  Notify notify;
  notify.ready();
  std::uint64_t rounds = 0;
  while (!stop.wait_until(SteadyClock().now() + std::chrono::seconds(1))) {
    if (tour->rounds() != rounds) notify.keep_alive(SteadyClock().now());
    rounds = tour->rounds();
    notify.status(inspection.status().state());
    tour->read_plan();
    record.write(tour->take_recording());
    position.write(tour->position());
  }
  notify.stopping();
  tour->stop();
  record.write(tour->take_recording());
  server->stop(std::chrono::milliseconds(500));
  return Done{};
}

}  // namespace
}  // namespace cyclorama::tour

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-tour",
                             "Leads the visit: follows the wand or the keys, requests pictures "
                             "from the farm, and feeds the displays.");
  cyclorama::tour::Options options;
  cyclorama::tour::add_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::tour::run(options, stop); });
}
