// SPDX-License-Identifier: Apache-2.0
/// cyclorama-operator: serves the page that shows the whole visit.
#include <fmt/format.h>

#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/address.h"
#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "kiosk/operator/page_certificate.h"
#include "kiosk/operator/page_server.h"
#include "kiosk/operator/reach_writer.h"
#include "kiosk/operator/self_check.h"
#include "kiosk/operator/setup_service.h"

namespace cyclorama::operations {
namespace {

constexpr Duration kSupervisePeriod = std::chrono::milliseconds(500);
constexpr Duration kReachPeriod = std::chrono::seconds(5);

struct Options {
  std::string listen = "[::1]:8443";
  std::vector<std::string> watches;
  std::optional<std::string> endpoints;
  bool has_no_pin = false;
  std::optional<std::string> museum;
  std::optional<std::string> keep;
  std::optional<std::string> calibrator;
  std::optional<std::string> requests;
  std::optional<std::string> reach;
  std::string run = "/run";
  std::string devices = "/sys/class";
  bool has_mdns = false;
};

void add_options(CLI::App& app, Options* options) {
  app.add_option("--listen", options->listen, "Address of the page")->capture_default_str();
  app.add_option(
         "--watch", options->watches,
         "NAME=ADDRESS of a process: tour, display, tracker, projectors, coordinator, simulated-room; repeat it")
      ->allow_extra_args(false);
  app.add_option("--endpoints", options->endpoints, "A file of [[watch]] tables, each with name and address");
  app.add_option("--museum", options->museum,
                 "The museum's state folder, written by cyclorama-provision: settings, PIN, state of updates");
  app.add_option("--keep", options->keep,
                 "Folder of the page's certificate, which is made at the first start, and of the recovery key");
  CLI::Option* const no_pin =
      app.add_flag("--no-pin", options->has_no_pin, "Serve HTTP without PIN and encryption, to this computer only");
  no_pin->excludes("--keep");
  app.add_option("--calibrator", options->calibrator, "HOST:PORT of the calibrator");
  app.add_option("--reach", options->reach,
                 "File to write how the page is reached, which the wall shows when somebody requests help");
  app.add_option("--run", options->run, "Folder in which cyclorama-network reports a network that is being tried")
      ->capture_default_str();
  app.add_option("--devices", options->devices, "The kernel's lists of devices: projectors, cables, cameras")
      ->capture_default_str();
  app.add_flag("--mdns", options->has_mdns, "This computer answers to NAME.local, so the wall shows that, too");
  app.add_option("--requests", options->requests,
                 "Folder for requests to the system: a file 'update' or 'factory-reset' triggers a systemd unit");
}

/// State of a page with a PIN; empty for a page without a PIN.
struct OperatorAccess {
  std::optional<PageCertificate> certificate;
  std::optional<HttpTls> tls;
  std::unique_ptr<Sessions> sessions;
};

Result<OperatorAccess> make_access(const Options& options, const Clock& clock) {
  OperatorAccess access;
  if (options.has_no_pin) return access;
  if (!options.museum || !options.keep) {
    return Error(
        ErrorCode::kInvalidArgument,
        "the page requires a PIN: name its folder with --museum FOLDER and the folder for the page's certificate "
        "with --keep FOLDER; or serve this computer alone with --no-pin");
  }
  TRY_ASSIGN(access.certificate, page_certificate(*options.keep, std::time(nullptr)));
  access.tls = HttpTls{access.certificate->certificate_pem, access.certificate->key_pem};
  access.sessions = std::make_unique<Sessions>(clock, MuseumState{*options.museum}.pin_file());
  return access;
}

/// Returns at the stop, or when the page needs another certificate. Meanwhile it lets the page answer itself, feeds the
/// watchdog whenever it does, so that systemd restarts a page that does not, and reports to the display. `reach` may be
/// null.
void watch_over(const SelfCheck& check, const OperatorAccess& access, ReachWriter* reach, const StopSignal& stop,
                Notify* notify) {
  std::string trouble;
  const auto report = [&](const Status& done) {
    const std::string sentence = done ? "" : done.error().message();
    if (sentence == trouble) return;
    trouble = sentence;
    notify->status(trouble.empty() ? "all is well again" : trouble);
    log(trouble.empty() ? LogLevel::kNotice : LogLevel::kError, trouble.empty() ? "all is well again" : trouble);
  };
  TimePoint reach_at{};
  while (!stop.wait_until(SteadyClock().now() + kSupervisePeriod)) {
    const TimePoint now = SteadyClock().now();
    const bool is_reach_due = reach != nullptr && now >= reach_at;
    if (!is_reach_due && !notify->is_due(now)) continue;
    if (access.certificate && is_to_be_renewed(*access.certificate, std::time(nullptr))) {
      // systemd starts this program again: at most once in two years, and when a lost clock was set.
      return log(LogLevel::kNotice, "the page's certificate is to be made anew, so the page starts again");
    }
    Status done = check.run();
    if (done) notify->keep_alive(SteadyClock().now());
    if (is_reach_due) {
      reach_at = now + kReachPeriod;
      const Status written = reach->write(done.has_value(), SteadyClock().now());
      if (done) done = written;
    }
    report(done);
  }
}

Status run(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(const std::vector<Endpoint> endpoints, gather_endpoints(options.watches, options.endpoints));
  TRY_ASSIGN(std::vector<ProcessLink> links, make_links(endpoints));
  const SteadyClock clock;
  TRY_ASSIGN(const OperatorAccess access, make_access(options, clock));
  std::unique_ptr<CalibrationController> calibration;
  std::unique_ptr<HealingController> healing;
  if (options.calibrator) {
    TRY_ASSIGN(calibration, CalibrationController::make(*options.calibrator));
    TRY_ASSIGN(healing, HealingController::make(*options.calibrator));
  }
  Watch watch(std::move(links));
  MuseumServices museum;
  museum.watch = &watch;
  museum.calibration = calibration.get();
  museum.healing = healing.get();
  museum.support.museum.root = options.museum.value_or("");
  museum.requests = options.requests.value_or("");
  if (options.keep) museum.recovery_key = std::filesystem::path(*options.keep) / "recovery-key";
  if (access.certificate) museum.fingerprint = access.certificate->fingerprint;
  const auto checks = [&] { return checks_of(findings_of(watch.observations(), museum.support.museum)); };
  std::optional<AlarmService> alarms;
  std::optional<CareLog> records;
  if (options.museum && options.keep) {
    alarms.emplace(
        AlarmService::Options{museum.support.museum, *options.keep, checks,
                              [port = parse_address(options.listen)] { return port ? outside_page(port->port) : ""; }});
    museum.alarms = &*alarms;
    records.emplace(CareLog::Options{museum.support.museum, *options.keep, &watch, checks});
    museum.log = &*records;
  }
  std::optional<SetupService> setup;
  if (options.museum && options.keep) {
    SetupPlace place{museum.support.museum, *options.keep, museum.requests, options.run, options.devices};
    for (const Endpoint& endpoint : endpoints)
      if (endpoint.name == "display") place.display = endpoint.address;
    setup.emplace(std::move(place));
  }
  PageExtras extras;
  extras.setup = setup ? &*setup : nullptr;
  if (options.museum) extras.museum = &museum;
  for (const Endpoint& endpoint : endpoints)
    if (endpoint.name == "tour") extras.tour = endpoint.address;
  extras.sessions = access.sessions.get();
  extras.sheet = [fingerprint = museum.fingerprint, listen = options.listen] {
    SheetFacts facts{fingerprint, {}};
    const auto here = parse_address(listen);
    for (const std::string& address : outside_addresses()) {
      const bool is_v6 = address.find(':') != std::string::npos;
      const int port = here ? here->port : 0;
      facts.addresses.push_back(is_v6 ? fmt::format("https://[{}]:{}/", address, port)
                                      : fmt::format("https://{}:{}/", address, port));
    }
    return facts;
  };
  extras.tls = access.tls ? &*access.tls : nullptr;
  TRY_ASSIGN(const std::unique_ptr<PageServer> page, PageServer::start(options.listen, &watch, extras));
  log(LogLevel::kNotice, fmt::format("the operator page listens on {} (port {})", options.listen, page->port()));
  if (access.certificate) {
    log(LogLevel::kInfo, fmt::format("its certificate is good until {}; SHA-256 {}", access.certificate->until,
                                     access.certificate->fingerprint));
  }
  const SelfCheck check(options.listen, page->port(), access.certificate ? SelfCheck::kTls : SelfCheck::kPlain);
  std::optional<ReachWriter> reach;
  if (options.reach) {
    reach.emplace(
        ReachWriter::Options{*options.reach, page->port(), museum.fingerprint, options.has_mdns, museum.support.museum},
        access.sessions.get());
  }
  Notify notify;
  notify.ready();
  watch_over(check, access, reach ? &*reach : nullptr, stop, &notify);
  notify.stopping();
  page->stop();
  return Done{};
}

}  // namespace
}  // namespace cyclorama::operations

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-operator",
                             "Serves a page that shows the visit live: pictures, numbers, the state "
                             "of every part, and steering by keys.");
  cyclorama::operations::Options options;
  cyclorama::operations::add_options(program.options(), &options);
  return program.run(argc, argv,
                     [&](const cyclorama::StopSignal& stop) { return cyclorama::operations::run(options, stop); });
}
