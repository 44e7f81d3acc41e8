// SPDX-License-Identifier: Apache-2.0
/// The farm over HTTP for operators.
///
///   GET /                  the page; its parts are /page.css, /page.js, /icon.svg
///   GET /status            status_json.h
///   GET /sessions          the open sessions: [ { id, museum, scene, frames_per_second, … } ]
///   GET /sessions/ID.mjpeg the session's pictures while it lasts, at most ten per second; `?half` halves their sides
///   GET /sessions/ID.jpg   its newest picture; 404 if it has none yet
///   GET /metrics           Prometheus
///   GET /health            {"healthy": …} with 200 or 503; the only path that needs no token
///
/// Errors are {"error": sentence} with 401, 403, 404, 429 (too many watchers) or 502.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/http/http_server.h"
#include "common/wire/inspection.pb.h"
#include "renderfarm/watch/access.h"
#include "renderfarm/watch/farm_metrics.h"
#include "renderfarm/watch/session_pictures.h"

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace cyclorama::watch {

/// Serves the farm over HTTP. Threads: those of HttpServer; watchers occupy at most kMaxWatchers of them. Thread-bound.
class WatchServer {
 public:
  static constexpr int kMaxWatchers = 4;

  /// Sources of the content; borrowed and thread-safe.
  struct Sources {
    std::function<wire::ProcessStatus()> status;
    const FarmMetrics& metrics;
    SessionPictures& pictures;  ///< stop() closes them.
  };
  /// Errors: those of HttpServer::start().
  static Result<std::unique_ptr<WatchServer>> start(const std::string& address, Access access, Sources sources);
  ~WatchServer();
  WatchServer(const WatchServer&) = delete;
  WatchServer& operator=(const WatchServer&) = delete;

  [[nodiscard]] int port() const { return http_->port(); }
  /// Idempotent.
  void stop();

 private:
  WatchServer(Access access, Sources sources) : access_(std::move(access)), sources_(std::move(sources)) {}
  void add_routes(httplib::Server& server);
  /// Answers a request that is not permitted. Returns true if it answered.
  bool turn_away(const httplib::Request& request, httplib::Response& response) const;
  void answer_picture(std::uint64_t session, bool half, httplib::Response& response) const;
  void answer_pictures(std::uint64_t session, bool half, httplib::Response& response);

  const Access access_;
  const Sources sources_;
  std::atomic<int> watchers_ = 0;
  std::unique_ptr<HttpServer> http_{};
};

}  // namespace cyclorama::watch
