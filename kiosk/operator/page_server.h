// SPDX-License-Identifier: Apache-2.0
/// The operator's page over HTTP.
///
///   GET  /                           the page; its parts beneath /page.css, /page.js
///   GET  /status                     status_json.h
///   GET  /picture/PROCESS/NAME.jpg   the newest picture; NAME may hold '/' (encoded or not). 404: not there (yet)
///   GET  /metrics                    metrics.h
///   POST /steer                      {"forward", "right", "turn"} as application/json; 204
///
/// Errors are {"error": sentence} with 400, 404, 413, 415, 502 (the process is away) or 504 (it hangs).
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "common/base/result.h"
#include "kiosk/operator/watch.h"

namespace httplib {
class Server;
}

namespace cyclorama {

/// Threads: `listen` and a fixed pool; a connection that is silent for some seconds is closed, and bodies beyond 4 KiB
/// are refused. Only a request that says application/json steers, which a foreign page in the same browser cannot send.
/// Thread-bound.
class PageServer {
 public:
  /// `watch` is borrowed. `address` as for WireServer: "[::1]:8080", port 0 takes a free one.
  /// kInvalidArgument  not HOST:PORT.     kBusy  the port is taken, or the address is not of this machine.
  static Result<std::unique_ptr<PageServer>> start(const std::string& address, Watch* watch);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Idempotent.
  void stop();

 private:
  PageServer();
  std::unique_ptr<httplib::Server> server_;
  int port_ = 0;
  std::thread listener_;
};

}  // namespace cyclorama
