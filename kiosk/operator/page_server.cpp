// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/page_server.h"

#include <httplib.h>

#include "common/base/address.h"
#include "common/base/text.h"
#include "kiosk/operator/login_checks.h"
#include "kiosk/operator/metrics.h"
#include "kiosk/operator/page_files.h"
#include "kiosk/operator/page_gate.h"
#include "kiosk/operator/page_language.h"
#include "kiosk/operator/status_json.h"
#include "kiosk/operator/stop_routes.h"

namespace cyclorama::operations {
namespace {

constexpr std::size_t kMaxBodyBytes = std::size_t{64} * 1024;  // A certificate with its chain, or a step's fields.

void serve_state(httplib::Server& server, Watch* watch, MuseumServices* museum) {
  server.Get("/status", [watch](const httplib::Request& request, httplib::Response& response) {
    answer_json(request, status_json(watch->observations()), response);
  });
  server.Get("/metrics", [watch, museum](const httplib::Request&, httplib::Response& response) {
    std::string text = metrics_text(watch->observations());
    if (museum != nullptr && museum->log != nullptr) {
      const Findings findings = findings_of(watch->observations(), museum->support.museum);
      text += museum_metrics_text(checks_of(findings), museum->log->report().total);
    }
    response.set_content(text, "text/plain; version=0.0.4");
  });
  server.Get(R"(/picture/([^/]+)/(.+)\.jpg)", [watch](const httplib::Request& request, httplib::Response& response) {
    // The wire carries only UTF-8; other bytes become '?', which no picture's name contains.
    const auto picture = watch->picture(request.matches[1].str(), printable(request.matches[2].str(), 200));
    if (!picture) return answer_error(picture.error(), response);
    response.set_content((*picture)->jpeg(), "image/jpeg");
  });
}

void serve_steering(httplib::Server& server, Watch* watch) {
  server.Post("/steer", [watch](const httplib::Request& request, httplib::Response& response) {
    const auto wanted = parse_steer(request.body);
    if (!wanted) return answer_error(wanted.error(), response);
    if (const Status sent = watch->steer(*wanted); !sent) return answer_error(sent.error(), response);
    response.status = 204;
  });
}

}  // namespace

Result<std::unique_ptr<PageServer>> PageServer::start(const std::string& address, Watch* watch,
                                                      const PageExtras& extras) {
  TRY(parse_address(address));
  if (extras.sessions == nullptr && !is_loopback(address)) {
    return Error(ErrorCode::kInvalidArgument,
                 "without a PIN the page may only listen on this computer itself, such as [::1]:8080");
  }
  if (extras.sessions != nullptr && extras.tls == nullptr) {
    return Error(ErrorCode::kInvalidArgument, "a PIN may not cross a network in the clear; it needs TLS");
  }
  const auto routes = [&](httplib::Server& server) {
    guard(
        server, extras.sessions, login_files(),
        [museum = extras.museum]() -> std::vector<Check> {
          return museum == nullptr ? std::vector<Check>{} : login_page_checks(museum->support.museum);
        },
        [museum = extras.museum](std::string_view authorization) {
          return museum != nullptr && admits_scraper(museum->support.museum, authorization);
        });
    serve_languages(server, [museum = extras.museum]() -> std::string {
      return museum == nullptr ? "" : language_of(museum->support.museum);
    });
    serve_page(server, page_files());
    serve_state(server, watch, extras.museum);
    serve_steering(server, watch);
    if (!extras.tour.empty()) serve_stops(server, extras.tour);
    if (extras.museum != nullptr) serve_museum(server, extras.museum);
    if (extras.setup != nullptr) serve_setup(server, extras.setup, extras.sessions, extras.sheet);
  };
  HttpLimits limits;
  limits.max_body_bytes = kMaxBodyBytes;
  TRY_ASSIGN(auto server, HttpServer::start(address, limits, routes,
                                            extras.tls == nullptr ? std::nullopt : std::optional(*extras.tls)));
  return std::unique_ptr<PageServer>(new PageServer(std::move(server)));
}

}  // namespace cyclorama::operations
