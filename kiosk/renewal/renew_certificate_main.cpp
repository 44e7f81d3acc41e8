// SPDX-License-Identifier: Apache-2.0
/// cyclorama-renew-certificate: gets this museum's next certificate from its farm.
#include <chrono>
#include <string>

#include "common/opening/wall_clock.h"
#include "common/process/log.h"
#include "common/process/program.h"
#include "kiosk/renewal/renew_certificate.h"
#include "kiosk/tour/session/tour_settings.h"
#include "renderfarm/client/certificate_client.h"

namespace cyclorama::renewal {
namespace {

struct Options {
  std::string config = "/etc/cyclorama/site.toml";
  std::string folder = "/var/lib/cyclorama-update";
};

Status run(const Options& options) {
  TRY_ASSIGN(const tour::TourSettings tour, tour::read_tour_settings(options.config));
  if (!tour.tls) {
    log(LogLevel::kInfo, "site.toml names no certificate");
    return Done{};
  }
  RenewalOrder order{.tls = *tour.tls, .folder = options.folder};
  // A lost clock shows a day long before the end of any certificate, so nothing is due.
  order.now = wall_time(std::chrono::system_clock::now());
  order.ask = [&](const std::string& request) { return client::renew_at_farm(tour.coordinators, *tour.tls, request); };
  TRY_ASSIGN(const RenewalOutcome outcome, renew_certificate(order));
  log(outcome.kind == RenewalOutcome::Kind::kNotDue ? LogLevel::kInfo : LogLevel::kNotice, outcome.sentence);
  return Done{};
}

}  // namespace
}  // namespace cyclorama::renewal

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-renew-certificate",
                             "Requests this museum's next certificate from its farm, 30 days before the present one "
                             "ends. It takes nothing into use: cyclorama-provision renew does.");
  cyclorama::renewal::Options options;
  program.options().add_option("--config", options.config, "The museum's site.toml: [farm]")->capture_default_str();
  program.options()
      .add_option("--folder", options.folder,
                  "Folder of the next key; its folder 'renewed' has key and certificate once both are complete")
      ->capture_default_str();
  return program.run(argc, argv, [&](const cyclorama::StopSignal&) { return cyclorama::renewal::run(options); });
}
