// SPDX-License-Identifier: Apache-2.0
/// cyclorama-tidy: what a museum's computer keeps, kept within bounds.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/process/log.h"
#include "common/process/program.h"
#include "kiosk/tidy/tidy.h"

namespace cyclorama {
namespace {

struct Options {
  std::vector<std::string> folders;
  double most_mb = 0.0;
  double least_free_mb = 0.0;
  std::size_t keep = 2;
  bool only_look = false;
};

Status run(const Options& options) {
  const TidyLimits limits{static_cast<std::uint64_t>(1e6 * options.most_mb),
                          static_cast<std::uint64_t>(1e6 * options.least_free_mb), options.keep};
  for (const std::string& folder : options.folders) {
    const auto gone = tidy(folder, limits, options.only_look);
    // What was never made needs no room.
    if (!gone && gone.error().code() == ErrorCode::kNotFound) continue;
    if (!gone) return gone.error();
    for (const TidyEntry& entry : *gone) {
      log(LogLevel::kInfo, fmt::format("{} '{}/{}', {:.1f} MB", options.only_look ? "would remove" : "removed", folder,
                                       entry.name, 1e-6 * static_cast<double>(entry.bytes)));
    }
  }
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  cyclorama::Program program(
      "cyclorama-tidy",
      "Removes the oldest entries of folders that take too much of the disk, but never what is in "
      "use: what a link in the folder or beside it leads to.");
  cyclorama::Options options;
  CLI::App& app = program.options();
  app.add_option("FOLDER", options.folders,
                 "Whose entries, files or folders, may go; one that is not there is no error")
      ->required();
  app.add_option("--most-mb", options.most_mb, "So much may a folder take; 0: any")->check(CLI::Range(0.0, 1e9));
  app.add_option("--least-free-mb", options.least_free_mb, "So much must be free on its disk; 0: any")
      ->check(CLI::Range(0.0, 1e9));
  app.add_option("--keep", options.keep, "So many of the newest stay, whatever they take")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  app.add_flag("--only-look", options.only_look, "Say what would go");
  return program.run(argc, argv, [&](const cyclorama::StopSignal&) { return cyclorama::run(options); });
}
