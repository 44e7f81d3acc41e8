// SPDX-License-Identifier: Apache-2.0
/// The operator page over HTTP.
///
///   GET  /                           the page; its other files as /page.css, /page.js
///   GET  /status                     status_json.h
///   GET  /picture/PROCESS/NAME.jpg   the newest picture; NAME may contain '/' (encoded or not). 404: none (yet)
///   GET  /metrics                    metrics.h
///   GET  /door                       {"checks": []}: why nobody can log in yet; needs no PIN (login_checks.h)
///   POST /steer                      {"forward", "right", "turn"} as application/json; 204
///   and the requests of museum_routes.h, setup_routes.h and stop_routes.h.
///
/// Errors are {"error": sentence} with 400, 401 (no PIN was entered: page_gate.h), 403, 404, 413, 415, 421, 429, 502
/// (the process is away) or 504 (it hangs).
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/http/http_server.h"
#include "kiosk/operator/museum_routes.h"
#include "kiosk/operator/sessions.h"
#include "kiosk/operator/setup_routes.h"
#include "kiosk/operator/watch.h"

namespace cyclorama::operations {

/// A page's parts besides the watched processes. Pointers are borrowed, and each may be null.
struct PageExtras {
  MuseumServices* museum = nullptr;
  Sessions* sessions = nullptr;  ///< Null: no PIN; for this computer only.
  const HttpTls* tls = nullptr;
  std::string tour{};  ///< Address of the tour; empty: none is watched.
  SetupService* setup = nullptr;
  std::function<SheetFacts()> sheet{};  ///< For the installer's sheet; set with `setup`.
};

/// Serves the page. Threading and limits are those of HttpServer. Thread-bound.
class PageServer {
 public:
  /// `watch` is borrowed. `address` has the form that WireServer expects: "[::1]:8080"; port 0 selects a free port.
  /// Errors: those of HttpServer::start(); kInvalidArgument if the address is not loopback and there is no PIN, or
  /// there is a PIN without TLS.
  static Result<std::unique_ptr<PageServer>> start(const std::string& address, Watch* watch,
                                                   const PageExtras& extras = {});

  [[nodiscard]] int port() const { return server_->port(); }
  /// Idempotent.
  void stop() { server_->stop(); }

 private:
  explicit PageServer(std::unique_ptr<HttpServer> server) : server_(std::move(server)) {}
  std::unique_ptr<HttpServer> server_;
};

}  // namespace cyclorama::operations
