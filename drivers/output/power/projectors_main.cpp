// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/language/marked_texts.h"
#include "common/opening/hours_override.h"
#include "common/opening/wall_clock.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "common/room/installation.h"
#include "common/wire/channel.h"
#include "common/wire/inspection_service.h"
#include "drivers/output/power/pjlink.h"
#include "drivers/output/power/projector_duty.h"
#include "drivers/output/power/projector_report.h"

namespace cyclorama::output {
namespace {

constexpr auto kAnswerTimeout = std::chrono::seconds(5);
constexpr auto kAgainAfter = std::chrono::seconds(5);
constexpr auto kLookEvery = std::chrono::seconds(20);
constexpr auto kTurn = std::chrono::milliseconds(200);  // Time within which a stop request is noticed.

struct Options {
  std::string command;
  std::vector<std::string> projectors;
  std::string password_file;
  double within_s = 240.0;
  std::string installation;
  std::string config;
  std::string hours_override;
  std::string listen;
};

struct NamedProjector {
  std::string name;  ///< Name or address, as given.
  PjlinkProjector pjlink;
};

Result<std::string> read_password(const std::filesystem::path& file) {
  if (file.empty()) return std::string();
  TRY_ASSIGN(std::string password, read_text_file(file, 256));
  while (!password.empty() && (password.back() == '\n' || password.back() == '\r')) password.pop_back();
  return password;
}

/// Returns the projectors of the command line, and those of the installation that have an address.
Result<std::vector<NamedProjector>> projectors_of(const Options& options) {
  std::vector<NamedProjector> projectors;
  TRY_ASSIGN(const std::string password, read_password(options.password_file));
  for (const std::string& text : options.projectors) {
    TRY_ASSIGN(Address address, parse_projector_address(text));
    projectors.push_back({text, {std::move(address), password}});
  }
  if (!options.installation.empty()) {
    TRY_ASSIGN(const Installation installation, read_installation(options.installation));
    for (const InstalledProjector& projector : installation.projectors) {
      if (!projector.pjlink) continue;
      TRY_ASSIGN(std::string own, read_password(projector.pjlink->password_file));
      projectors.push_back({projector.name, {projector.pjlink->address, std::move(own)}});
    }
  }
  return projectors;
}

/// Repeats the command until the projector accepts it, at most until `deadline`: a projector that cools down accepts
/// none for a minute or two.
Status bring(const PjlinkProjector& projector, bool is_on, TimePoint deadline, const StopSignal& stop) {
  for (;;) {
    auto set = set_power(projector, is_on, kAnswerTimeout);
    if (set || set.error().code() != ErrorCode::kUnavailable) return set;
    const TimePoint again = SteadyClock().now() + kAgainAfter;
    if (again > deadline || stop.wait_until(again)) return set;
  }
}

Status switch_or_query(const Options& options, const std::vector<NamedProjector>& projectors, const StopSignal& stop) {
  const TimePoint deadline =
      SteadyClock().now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.within_s));
  std::size_t failed = 0;
  for (const auto& [name, pjlink] : projectors) {
    if (stop.requested()) return Error(ErrorCode::kUnavailable, fmt::format("stopped before projector {}", name));
    auto done = options.command == "ask" ? Status(Done{}) : bring(pjlink, options.command == "on", deadline, stop);
    const auto power = done ? query_power(pjlink, kAnswerTimeout) : Result<ProjectorPower>(std::move(done).error());
    if (power) {
      fmt::print("{}: {}\n", name, text_of(*power));
    } else {
      ++failed;
      log(LogLevel::kWarning, power.error().message());
    }
  }
  if (failed == 0) return Done{};
  return Error(ErrorCode::kUnavailable, fmt::format("{} of {} projectors failed", failed, projectors.size()));
}

/// A controlled projector and the last report about it.
struct Kept {
  NamedProjector projector;
  ProjectorDuty duty{};
  ProjectorReporter reporter{};
  ProjectorReport report{ProjectorReport::Level::kOk, "It has not been queried yet.", ""};
  std::string said{};
};

void look_after(bool should_be_on, TimePoint now, Kept* kept) {
  const auto say = [&](LogLevel level, const std::string& text) {
    if (text != kept->said) log(level, text);
    kept->said = text;
  };
  const PjlinkProjector& pjlink = kept->projector.pjlink;
  const auto power = query_power(pjlink, kAnswerTimeout);
  std::optional<ProjectorErrors> errors;
  if (power) {
    // Optional: not all projectors report errors, and switching does not depend on them.
    if (const auto reported = query_errors(pjlink, kAnswerTimeout)) errors = *reported;
  }
  kept->report = kept->reporter.see({should_be_on, power, errors}, now);
  const auto wanted = kept->duty.next(should_be_on, power ? std::optional(*power) : std::nullopt);
  if (!power) return say(LogLevel::kWarning, power.error().message());
  const bool is_well = kept->report.level == ProjectorReport::Level::kOk;
  say(is_well ? LogLevel::kInfo : LogLevel::kWarning,
      fmt::format("{}: {}{}{}", kept->projector.name, text_of(*power), is_well ? "" : ". ",
                  is_well ? "" : kept->report.sentence));
  if (!wanted) return;
  if (auto set = set_power(pjlink, *wanted, kAnswerTimeout); !set)
    return say(LogLevel::kWarning, set.error().message());
  log(LogLevel::kInfo, fmt::format("{}: switched {}", kept->projector.name, *wanted ? "on" : "off"));
}

/// Publishes the table "projectors" of name, level, sentence and remedy for the operator.
void tell(const std::vector<Kept>& all, InspectionService* inspection) {
  wire::Table table;
  table.set_name("projectors");
  for (const char* const column : {"name", "level", "sentence", "remedy"}) table.add_columns(column);
  std::size_t well = 0;
  for (const Kept& kept : all) {
    if (kept.report.level == ProjectorReport::Level::kOk) ++well;
    wire::Row* const row = table.add_rows();
    row->add_cells()->set_text(kept.projector.name);
    row->add_cells()->set_text(std::string(to_text(kept.report.level)));
    row->add_cells()->set_text(kept.report.sentence);
    row->add_cells()->set_text(kept.report.remedy);
  }
  inspection->set_table(std::move(table));
  inspection->set_state(
      all.empty() ? translatable("No projector has a network address in the settings, so they are switched by hand.")
                  : fmt::format(translatable("{} of {} projectors are as they should be."), well, all.size()),
      well == all.size());
}

Status keep_hours(const Options& options, const std::vector<NamedProjector>& projectors, const StopSignal& stop) {
  if (options.config.empty())
    return Error(ErrorCode::kInvalidArgument, "keep needs --config, the museum's site.toml with its [hours]");
  TRY_ASSIGN(OpeningHours settings, read_opening_hours(std::filesystem::path(options.config)));
  OverriddenHours hours(std::move(settings), options.hours_override);
  if (projectors.empty()) log(LogLevel::kNotice, "no projector has pjlink = \"HOST\": none is switched");
  std::vector<Kept> all;
  for (const NamedProjector& projector : projectors) all.push_back({projector});
  InspectionService inspection("projectors");
  tell(all, &inspection);
  std::unique_ptr<WireServer> server;
  if (!options.listen.empty()) {
    TRY_ASSIGN(server, WireServer::start(options.listen, {&inspection}));
  }
  const SteadyClock clock;
  Notify notify;
  notify.ready();
  while (!stop.requested()) {
    const TimePoint again_at = clock.now() + kLookEvery;
    for (Kept& kept : all) {
      look_after(hours.is_open(wall_time(std::chrono::system_clock::now())), clock.now(), &kept);
      tell(all, &inspection);
      notify.keep_alive(clock.now());
      if (stop.requested()) break;
    }
    while (!stop.requested() && clock.now() < again_at) {
      clock.wait_until(clock.now() + kTurn);
      notify.keep_alive(clock.now());
    }
  }
  notify.stopping();
  if (server) server->stop(std::chrono::milliseconds(200));
  return Done{};
}

Status run(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(const std::vector<NamedProjector> projectors, projectors_of(options));
  const bool is_keep = options.command == "keep";
  // `keep` is valid for a museum whose projectors have no network address; every other command needs a projector.
  if (projectors.empty() && (!is_keep || options.installation.empty())) {
    return Error(ErrorCode::kInvalidArgument,
                 "no projector is named; write HOST, or --installation with a [[projector]] that has pjlink = "
                 "\"HOST\"");
  }
  return is_keep ? keep_hours(options, projectors, stop) : switch_or_query(options, projectors, stop);
}

}  // namespace
}  // namespace cyclorama::output

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::output;
  Program program(
      "cyclorama-projectors",
      "Switches projectors on and off over the network (PJLink class 1), reports their state, or keeps them to "
      "the museum's hours.");
  Options options;
  program.options()
      .add_option("command", options.command,
                  "on, off, ask; or keep: on while the museum is open and off while it is closed, until it is stopped")
      ->required()
      ->check(CLI::IsMember({"on", "off", "ask", "keep"}));
  program.options().add_option("projectors", options.projectors,
                               "HOST or HOST:PORT of each; port 4352 if none is given");
  program.options().add_option("--installation", options.installation,
                               "The room (TOML): its projectors that have pjlink = \"HOST\"");
  program.options().add_option("--config", options.config, "With keep: the museum's site.toml: [hours]");
  program.options().add_option("--hours-override", options.hours_override,
                               "With keep: the file with the operator page's override of [hours]");
  program.options().add_option("--listen", options.listen,
                               "With keep: HOST:PORT that serves the projectors' states to the operator; absent: none");
  program.options().add_option("--password-file", options.password_file,
                               "A file that holds the password of the projectors named here");
  program.options()
      .add_option("--within", options.within_s, "Seconds to retry a projector that cannot switch now")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(options, stop); });
}
