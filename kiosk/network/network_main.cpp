// SPDX-License-Identifier: Apache-2.0
/// cyclorama-network: joins the museum's network as its settings say.
#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "common/base/file.h"
#include "common/network/network_settings.h"
#include "common/process/child.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "kiosk/network/network_trial.h"

namespace cyclorama::network {
namespace {

struct Options {
  std::string run = "/run";
  std::string settings = "/etc/cyclorama";
  std::string reload = "/usr/lib/cyclorama/network-reload";
  std::string offer = "/var/lib/cyclorama-operator/offer";
  std::string code;
  std::string keep = "/run/cyclorama-requests/network-keep";
  std::string install = "cyclorama-offer.service";
  double seconds = 60.0;
  std::string file;
};

void add_options(CLI::App& app, Options* options) {
  app.require_subcommand(1);
  app.add_option("--run", options->run, "Folder of the files for systemd-networkd")->capture_default_str();
  app.add_option("--settings", options->settings, "Folder of the settings in use")->capture_default_str();
  app.add_option("--reload", options->reload, "Program that makes others read their files; it gets the changed names")
      ->capture_default_str();
  app.add_subcommand("apply", "Make the network of the settings in use; does nothing while others are being tried");
  CLI::App& trial =
      *app.add_subcommand("try", "Make the network of an offer, and take it back unless somebody confirms it");
  trial.add_option("CODE", options->code, "Text that confirms this trial")->required();
  trial.add_option("--offer", options->offer, "Folder with another site.toml")->capture_default_str();
  trial.add_option("--keep", options->keep, "File in which the code appears as confirmation")->capture_default_str();
  trial.add_option("--seconds", options->seconds, "How long to wait for it")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  trial.add_option("--install", options->install, "systemd unit that takes the confirmed offer into use")
      ->capture_default_str();
  CLI::App& check = *app.add_subcommand("check", "Report the first mistake in [network] of a site.toml");
  check.add_option("FILE", options->file, "The site.toml")->required();
}

Status install_with(const std::string& unit) {
  ChildLimits limits;
  limits.time_limit = std::chrono::minutes(20);  // The checker's programs may take five minutes each.
  TRY_ASSIGN(const ChildEnd end, run_child({"systemctl", "start", unit}, limits));
  if (end.exit_code == 0) return Done{};
  return Error(ErrorCode::kBadData, "the settings as a whole were refused; the card 'Settings' has the reason");
}

Status run(const Options& options, const CLI::App& app, const StopSignal& stop) {
  if (app.got_subcommand("check")) {
    TRY(read_network_settings(options.file));
    return Done{};
  }
  const NetworkPlace place{options.run, options.settings, {options.reload}};
  if (app.got_subcommand("apply")) return apply_in_use(place);
  TrialOrder order;
  order.offer = options.offer;
  order.code = options.code;
  order.keep = options.keep;
  order.length = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.seconds));
  order.install = [&] { return install_with(options.install); };
  TRY_ASSIGN(const TrialEnd end,
             run_trial(place, order, SteadyClock(), [&](TimePoint until) { return stop.wait_until(until); }));
  log(LogLevel::kNotice, end == TrialEnd::kKept
                             ? "the new network settings are kept"
                             : "the network settings of before are in use again: " + read_trial(options.run).sentence);
  return Done{};
}

}  // namespace
}  // namespace cyclorama::network

int main(int argc, char** argv) {
  cyclorama::Program program(
      "cyclorama-network",
      "Joins the museum's network as [network] in site.toml states, and tries other settings for "
      "a minute.");
  cyclorama::network::Options options;
  cyclorama::network::add_options(program.options(), &options);
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) {
    return cyclorama::network::run(options, program.options(), stop);
  });
}
