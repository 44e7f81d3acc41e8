// SPDX-License-Identifier: Apache-2.0
/// cyclorama-fetch-update: looks for a newer version of this computer's image at the farm.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/address.h"
#include "common/base/file.h"
#include "common/opening/wall_clock.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "common/update/update_manifest.h"
#include "kiosk/tour/session/tour_settings.h"
#include "kiosk/update/fetch_update.h"
#include "kiosk/update/update_settings.h"
#include "kiosk/update/update_status.h"

namespace cyclorama::update {
namespace {

constexpr const char* kNight = "night";
constexpr const char* kNow = "now";
constexpr std::size_t kMaxTextBytes = 64 * 1024;

struct Options {
  std::string config = "/etc/cyclorama/site.toml";
  std::string release = "/etc/os-release";
  std::string key = "/usr/share/cyclorama/update.pub";
  std::string state = "/var/lib/cyclorama";
  std::string folder = "/var/lib/cyclorama-update";
  std::string when = kNight;
  bool only_is_night = false;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--config", options->config, "The museum's site.toml: [farm], [hours], [update]")
      ->capture_default_str();
  app.add_option("--release", options->release, "File with IMAGE_ID and IMAGE_VERSION")->capture_default_str();
  app.add_option("--key", options->key, "Public key for the signature of versions")->capture_default_str();
  app.add_option("--state", options->state,
                 "Folder of update.json, the result of the last update, and of the override of [hours]")
      ->capture_default_str();
  app.add_option("--folder", options->folder,
                 "Folder for the download: its folder 'offer' collects a version, its file 'result' has the result")
      ->capture_default_str();
  app.add_option("--when", options->when, "night: only within [update] hours, while the museum is closed; now: at once")
      ->check(CLI::IsMember({kNight, kNow}))
      ->capture_default_str();
  app.add_flag("--is-night", options->only_is_night,
               "Fetches nothing; succeeds within [update] hours, while the museum is closed");
}

/// Returns the value of KEY=VALUE in an os-release file, without quotes.
std::string value_of(const std::string& text, const std::string& key) {
  const std::string begin = "\n" + key + "=";
  const std::string lines = "\n" + text;
  const std::size_t at = lines.find(begin);
  if (at == std::string::npos) return "";
  std::string value = lines.substr(at + begin.size(), lines.find('\n', at + 1) - at - begin.size());
  std::erase(value, '"');
  return value;
}

/// Returns the newest version that must not be fetched again: seen before, written already, or rolled back.
std::string not_again(const Options& options) {
  const std::filesystem::path seen = std::filesystem::path(options.state) / "update-seen";
  if (const auto line = read_text_file(seen, kMaxTextBytes)) {
    const std::string version = line->substr(0, line->find('\n'));
    if (is_image_version(version)) return version;
  }
  const auto text = read_text_file(std::filesystem::path(options.state) / kUpdateStatusFile, kMaxTextBytes);
  const auto status = text ? parse_update_status(*text) : Result<UpdateStatus>(text.error());
  const bool counts =
      status && (status->state == UpdateStatus::State::kReady || status->state == UpdateStatus::State::kRolledBack);
  return counts ? status->available : "";
}

/// Writes the result for the script that started this program. `word` is nothing, ready, later or failed.
Status tell(const Options& options, const std::string& word, const std::string& sentence) {
  log(word == "failed" ? LogLevel::kWarning : LogLevel::kInfo, sentence);
  return write_file_atomically(std::filesystem::path(options.folder) / "result",
                               std::string_view(fmt::format("{} {}\n", word, sentence)));
}

Result<FetchOutcome> look(const Options& options, const tour::TourSettings& tour, const std::function<bool()>& go_on) {
  TRY_ASSIGN(const std::string release, read_text_file(options.release, kMaxTextBytes));
  FetchOrder order{.image = value_of(release, "IMAGE_ID"), .version = value_of(release, "IMAGE_VERSION")};
  if (!is_image_name(order.image) || !is_image_version(order.version)) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' names no image of ours", options.release));
  }
  order.not_again = not_again(options);
  order.key = options.key;
  order.folder = std::filesystem::path(options.folder) / "offer";
  if (options.when == kNow) order.retries = 2;  // An operator waits for the result.
  TRY_ASSIGN(client::UpdateClient farm, client::UpdateClient::make(tour.coordinators, tour.tls));
  return fetch_update(order, &farm, go_on);
}

Status run(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(const UpdateSettings settings, read_update_settings(options.config));
  const auto is_night = [&] {
    const auto override = read_hours_override(std::filesystem::path(options.state) / kHoursOverrideFile);
    return settings.is_night(wall_time(std::chrono::system_clock::now()), override ? *override : std::nullopt);
  };
  if (options.only_is_night) {
    return is_night() ? Status(Done{}) : Error(ErrorCode::kUnavailable, "it is not the time for updates");
  }
  const auto go_on = [&] { return !stop.requested() && (options.when == kNow || is_night()); };
  if (!go_on()) return tell(options, "later", "it is not the time for updates");
  TRY_ASSIGN(const tour::TourSettings tour, tour::read_tour_settings(options.config));
  const bool is_alone = !tour.tls && std::ranges::all_of(tour.coordinators, [](const std::string& coordinator) {
    return is_loopback(coordinator);
  });
  if (!settings.from_farm || is_alone) {
    return tell(options, "nothing",
                is_alone ? "no farm is named in site.toml" : "site.toml says that updates come by stick");
  }
  const auto outcome = look(options, tour, go_on);
  if (!outcome) return tell(options, "failed", outcome.error().message());
  switch (outcome->kind) {
    case FetchOutcome::Kind::kNothing:
      return tell(options, "nothing", outcome->sentence);
    case FetchOutcome::Kind::kReady:
      return tell(options, "ready", outcome->sentence);
    case FetchOutcome::Kind::kLater:
      break;
  }
  return tell(options, "later", outcome->sentence);
}

}  // namespace
}  // namespace cyclorama::update

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-fetch-update",
                             "Fetches a newer version of this museum's image from the farm, if there is one: signed, "
                             "whole, and resumed where it was cut. It installs nothing.");
  cyclorama::update::Options options;
  cyclorama::update::add_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::update::run(options, stop); });
}
