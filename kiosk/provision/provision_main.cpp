// SPDX-License-Identifier: Apache-2.0
/// cyclorama-provision: takes a museum's settings from a USB stick into use.
#include <fmt/format.h>

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include "common/base/file.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "kiosk/provision/certificate_renewal.h"
#include "kiosk/provision/provision.h"

namespace cyclorama::provision {
namespace {

constexpr const char* kMuseum = "museum";
constexpr const char* kFarmHost = "farm-host";
constexpr const char* kCheckGroup = "cyclorama-check";
constexpr std::size_t kMaxReportBytes = 256 * 1024;
/// A render host's settings include scenes; the limit of one file is that of FAT.
constexpr FolderLimits kFarmHostLimits{200, (std::size_t{4} << 30) - 1, std::size_t{16} << 30};

FolderLimits farm_host_limits(const std::filesystem::path& state) {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(state, unknown);
  return unknown ? kFarmHostLimits : within(space.available, kFarmHostLimits);
}

struct Options {
  std::string state = "/var/lib/cyclorama";
  std::string from;
  std::string programs = "/usr/bin";
  std::optional<std::string> changed;
  bool if_there = false;
  bool is_stick = false;
  bool is_over = false;
  bool for_any_computer = false;
  std::optional<std::string> confirmed;
  std::optional<std::string> checker;
  std::string verdict = "/run/cyclorama-check/verdict.json";
  std::string of = kMuseum;

  [[nodiscard]] SettingsOf owner() const { return of == kMuseum ? SettingsOf::kMuseum : SettingsOf::kFarmHost; }
};

void add_options(CLI::App& app, Options* options) {
  app.require_subcommand(1);
  app.add_option("--state", options->state, "Folder of the settings; the programs read its folder 'settings'")
      ->capture_default_str();
  app.add_option("--for", options->of, "Kind of computer: a museum's or a render host")
      ->check(CLI::IsMember({kMuseum, kFarmHost}))
      ->envname("CYCLORAMA_SETTINGS_FOR")
      ->capture_default_str();
  CLI::App& install = *app.add_subcommand("install", "Check a folder, and take its settings into use if they are good");
  CLI::App& check = *app.add_subcommand("check", "Check a folder, and report its problems; changes nothing in use");
  CLI::App& restore = *app.add_subcommand("restore", "Take the previous settings into use; a second time undoes this");
  CLI::App& renew =
      *app.add_subcommand("renew",
                          "Exchange the certificate for the farm: FOLDER has certificate.crt and key.pem, as made by "
                          "cyclorama-renew-certificate");
  CLI::App& verdict = *app.add_subcommand("verdict", "Check copied settings for --checker");
  app.add_subcommand("status", "Print the result of the last folder as JSON");
  for (CLI::App* const command : {&install, &check, &verdict}) {
    command
        ->add_option("FOLDER", options->from,
                     "With site.toml and installation.toml, or farm.toml and node.toml, and all that they name")
        ->required();
  }
  for (CLI::App* const command : {&install, &check, &renew, &verdict}) {
    command
        ->add_option("--programs", options->programs,
                     "Folder of the programs that check their own settings, such as cyclorama-display; empty: none")
        ->capture_default_str();
  }
  install.add_flag("--if-there", options->if_there, "A folder that is not there is no error");
  CLI::Option* const stick = install.add_flag(
      "--stick", options->is_stick,
      "Anybody can plug the folder in: after the first one, it needs the owner's signature or a confirmation");
  install
      .add_flag("--over", options->is_over,
                "The folder is an offer of the operator page: files of the settings in use that it lacks stay")
      ->excludes(stick);
  install.add_flag("--for-any-computer", options->for_any_computer,
                   "Projectors need neither a connector nor a serial: for the image's own settings");
  renew.add_option("FOLDER", options->from, "Folder with the next pair; it may belong to another user")->required();
  for (CLI::App* const command : {&install, &renew}) {
    command->add_option("--checker", options->checker,
                        "systemd unit that runs 'verdict' on the copy as another user, instead of checking it here");
  }
  for (CLI::App* const command : {&install, &renew, &verdict}) {
    command->add_option("--verdict", options->verdict, "File for the verdict of a checker")->capture_default_str();
  }
  install.add_option("--confirmed", options->confirmed, "File with the digest of a stick that the operator confirmed")
      ->needs(stick);
  for (CLI::App* const command : {&install, &restore}) {
    command->add_option("--changed", options->changed, "Write this file when the settings in use have changed");
  }
}

/// Remarks are not errors: the settings of a new image cause some until the first USB stick.
void say(const ProvisioningReport& report) {
  for (const std::string& remark : report.remarks) log(LogLevel::kNotice, remark);
  for (const std::string& problem : report.problems) log(LogLevel::kError, problem);
}

Status publish(const Options& options, const ProvisioningReport& report) {
  const bool is_new =
      report.verdict == ProvisioningVerdict::kInstalled || report.verdict == ProvisioningVerdict::kRestored;
  if (is_new && options.changed) TRY(write_file_atomically(*options.changed, report.in_use + "\n"));
  return write_file_atomically(std::filesystem::path(options.state) / kProvisioningReportFile, report_json(report));
}

/// Returns the digest in a file; empty, which confirms nothing, if there is none.
std::string digest_in(const std::string& path) {
  constexpr std::size_t kMaxDigestBytes = 100;
  const auto text = read_text_file(path, kMaxDigestBytes);
  return text ? text->substr(0, text->find('\n')) : "";
}

std::optional<SandboxedCheck> sandbox_of(const Options& options) {
  if (!options.checker) return std::nullopt;
  return SandboxedCheck{{"systemctl", "start", *options.checker}, options.verdict, kCheckGroup};
}

/// The page's report stays that of the settings, with another end of the certificate.
Status renew(const Options& options, SettingsStore* store) {
  const auto json = read_text_file(std::filesystem::path(options.state) / kProvisioningReportFile, kMaxReportBytes);
  TRY_ASSIGN(ProvisioningReport report, json ? parse_report(*json) : Result<ProvisioningReport>(json.error()));
  CertificateOrder order{options.from, {}, sandbox_of(options)};
  order.check.programs = options.programs;
  TRY(renew_certificate(order, store, &report));
  log(LogLevel::kNotice, fmt::format("the next certificate is in use, valid until {}", report.certificate_until));
  return publish(options, report);
}

Status run(const Options& options, const CLI::App& app) {
  if (app.got_subcommand("status")) {
    TRY_ASSIGN(const std::string json,
               read_text_file(std::filesystem::path(options.state) / kProvisioningReportFile, kMaxReportBytes));
    TRY(parse_report(json));
    std::fputs(json.c_str(), stdout);
    return Done{};
  }
  if (app.got_subcommand("verdict")) {
    const SettingsVerdict verdict = check_settings(options.from, {options.programs, options.owner()});
    return write_file_atomically(options.verdict, std::string_view(verdict_json(verdict)));
  }
  std::error_code unknown;
  if (options.if_there && !std::filesystem::exists(options.from, unknown) && !unknown) return Done{};
  TRY_ASSIGN(SettingsStore store, SettingsStore::open(options.state));
  const std::string at = time_text(std::time(nullptr));
  if (app.got_subcommand("restore")) {
    TRY_ASSIGN(const ProvisioningReport report, restore_settings(at, &store, options.owner()));
    say(report);
    log(LogLevel::kNotice, fmt::format("the previous settings are in use again, as {}", report.in_use));
    return publish(options, report);
  }
  if (app.got_subcommand("renew")) return renew(options, &store);
  ProvisionOrder order;
  order.from = options.from;
  order.check.programs = options.programs;
  order.check.of = options.owner();
  order.check.for_any_computer = options.for_any_computer;
  if (order.check.of == SettingsOf::kFarmHost) order.limits = farm_host_limits(options.state);
  order.only_check = app.got_subcommand("check");
  order.at = at;
  order.is_stick = options.is_stick;
  order.is_over = options.is_over;
  order.sandbox = sandbox_of(options);
  if (options.confirmed) order.confirmed = digest_in(*options.confirmed);
  auto report = provision(order, &store);
  if (!report) {
    // The page shows the failure, too, since nobody reads the journal.
    ProvisioningReport failed;
    failed.at = at;
    failed.source = options.from;
    failed.in_use = store.in_use();
    failed.problems = {report.error().message()};
    if (!order.only_check) static_cast<void>(publish(options, failed));
    return std::move(report).error();
  }
  say(*report);
  if (!order.only_check) TRY(publish(options, *report));
  switch (report->verdict) {
    case ProvisioningVerdict::kInstalled:
      log(LogLevel::kNotice, order.only_check ? "these settings are good, and differ from those in use"
                                              : fmt::format("the settings are in use, as {}", report->in_use));
      return Done{};
    case ProvisioningVerdict::kUnchanged:
      log(LogLevel::kNotice, fmt::format("these settings are in use already, as {}", report->in_use));
      return Done{};
    case ProvisioningVerdict::kUnconfirmed:
      return Error(ErrorCode::kUnavailable,
                   fmt::format("the stick with '{}' is not the owner's, and waits for a confirmation", options.from));
    default:
      return Error(ErrorCode::kBadData,
                   fmt::format("the settings in '{}' are refused for {} reason{}; {}", options.from,
                               report->problems.size(), report->problems.size() == 1 ? "" : "s",
                               report->in_use.empty() ? "there are none in use" : "the previous ones stay in use"));
  }
}

}  // namespace
}  // namespace cyclorama::provision

int main(int argc, char** argv) {
  cyclorama::Program program(
      "cyclorama-provision",
      "Takes a museum's or a render host's settings from a USB stick into use: all of them, checked, or none.");
  cyclorama::provision::Options options;
  cyclorama::provision::add_options(program.options(), &options);
  return program.run(
      argc, argv, [&](const cyclorama::StopSignal&) { return cyclorama::provision::run(options, program.options()); });
}
