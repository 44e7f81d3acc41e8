// SPDX-License-Identifier: Apache-2.0
/// cyclorama-health: runs once after every start, before the boot loader marks this version as good.
#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "kiosk/operator/health.h"

namespace cyclorama::operations {
namespace {

constexpr auto kBetweenLooks = std::chrono::seconds(1);

struct Options {
  std::vector<std::string> watches;
  std::optional<std::string> endpoints;
  std::optional<std::string> report;
  std::optional<std::string> dark_before;
  std::optional<std::string> note_dark;
  double deadline_s = 180.0;
  HealthRules rules;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--watch", options->watches, "NAME=ADDRESS of a process that must answer; repeat it")
      ->allow_extra_args(false);
  app.add_option("--endpoints", options->endpoints, "A file of [[watch]] tables, each with name and address");
  app.add_option("--well", options->rules.well,
                 "NAME of a process that must report that it is well, not only answer; repeat it")
      ->allow_extra_args(false);
  app.add_option("--heads", options->rules.heads,
                 "Minimum number of heads that show a picture, of all displays together")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_option("--looks", options->rules.looks, "Number of checks in a row, a second apart, that must succeed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--deadline", options->deadline_s, "Seconds until the command fails")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--dark-before", options->dark_before,
                 "A file from --note-dark: its heads need not be lit; without it all must be");
  app.add_option("--note-dark", options->note_dark, "Only write the heads that are dark now to this file, one a line");
  app.add_option("--report", options->report, "Write the verdict to this file, for the operator page");
}

Status note_dark(const std::vector<ProcessLink>& links, const std::string& path) {
  std::string lines;
  for (const std::string& head : dark_heads(look_at(links))) lines += head + "\n";
  return write_file_atomically(path, lines);
}

/// Returns the heads in the file; none if it cannot be read, so that no head is excused.
std::set<std::string> read_dark(const std::string& path) {
  std::set<std::string> dark;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) dark.insert(line);
  return dark;
}

Status run(Options options, const StopSignal& stop) {
  TRY_ASSIGN(const std::vector<Endpoint> endpoints, gather_endpoints(options.watches, options.endpoints));
  TRY_ASSIGN(const std::vector<ProcessLink> links, make_links(endpoints));
  if (options.note_dark) return note_dark(links, *options.note_dark);
  if (options.dark_before) options.rules.may_be_dark = read_dark(*options.dark_before);
  const SteadyClock clock;
  const TimePoint begin = clock.now();
  const TimePoint deadline =
      begin + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.deadline_s));
  HealthCount count(options.rules);
  TimePoint now = begin;
  do {
    count.take(look_at(links));
    now = clock.now();
  } while (!count.is_well() && now < deadline && !stop.wait_until(std::min(now + kBetweenLooks, deadline)));
  const double seconds = to_seconds(now - begin);
  if (options.report) {
    const Status written = write_file_atomically(*options.report, health_json(count, seconds));
    // A full disk is no reason to give up this version.
    if (!written) log(LogLevel::kWarning, written.error().message() + ", ignoring");
  }
  if (count.is_well()) {
    log(LogLevel::kNotice, fmt::format("every part works, after {:.0f} s", seconds));
    return Done{};
  }
  for (const std::string& missing : count.missing()) log(LogLevel::kWarning, missing);
  return Error(ErrorCode::kTimedOut,
               fmt::format("not well within {:.0f} s: {} thing{} missing", options.deadline_s, count.missing().size(),
                           count.missing().size() == 1 ? " is" : "s are"));
}

}  // namespace
}  // namespace cyclorama::operations

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-health",
                             "Waits until every part of a museum works and every head shows a picture; fails when that "
                             "takes too long; the computer then returns to the previous version.");
  cyclorama::operations::Options options;
  cyclorama::operations::add_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::operations::run(options, stop); });
}
