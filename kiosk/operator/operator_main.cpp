// SPDX-License-Identifier: Apache-2.0
/// cyclorama-operator: the page that shows the whole visit.
#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "common/process/log.h"
#include "common/process/notify.h"
#include "common/process/program.h"
#include "kiosk/operator/page_server.h"

namespace cyclorama {
namespace {

struct Options {
  std::string listen = "[::1]:8080";
  std::vector<std::string> watches;
  std::optional<std::string> endpoints;
};

Status run(const Options& options, const StopSignal& stop) {
  TRY_ASSIGN(const std::vector<Endpoint> endpoints, gather_endpoints(options.watches, options.endpoints));
  TRY_ASSIGN(std::vector<ProcessLink> links, make_links(endpoints));
  Watch watch(std::move(links));
  TRY_ASSIGN(const std::unique_ptr<PageServer> page, PageServer::start(options.listen, &watch));
  log(LogLevel::kNotice, fmt::format("the operator page listens on {} (port {})", options.listen, page->port()));
  if (!options.listen.starts_with("[::1]") && !options.listen.starts_with("127.") &&
      !options.listen.starts_with("localhost:")) {
    log(LogLevel::kWarning, "the page asks for no password: whoever reaches this address can steer the visit");
  }
  Notify notify;
  notify.ready();
  while (!stop.wait_until(SteadyClock().now() + std::chrono::seconds(1))) notify.keep_alive(SteadyClock().now());
  notify.stopping();
  page->stop();
  return Done{};
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  cyclorama::Program program("cyclorama-operator",
                             "Serves a page that shows the visit live: pictures, numbers, the state "
                             "of every part, and steering by keys.");
  cyclorama::Options options;
  program.options().add_option("--listen", options.listen, "Address of the page")->capture_default_str();
  program.options()
      .add_option("--watch", options.watches,
                  "NAME=ADDRESS of a process: tour, display, tracker, head, simulated-room; repeat it")
      ->allow_extra_args(false);
  program.options().add_option("--endpoints", options.endpoints,
                               "A file of [[watch]] tables, each with name and address");
  return program.run(argc, argv, [&](const cyclorama::StopSignal& stop) { return cyclorama::run(options, stop); });
}
