// SPDX-License-Identifier: Apache-2.0
/// HTTP as this house uses it: addresses, limits, headers, and errors as {"error": sentence}. cpp-httplib underneath.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/http/page_file.h"

namespace httplib {
class Server;
struct Response;
}  // namespace httplib

namespace cyclorama {

struct HttpLimits {
  std::size_t threads = 24;      ///< A browser holds six connections, each of which occupies one.
  std::size_t max_waiting = 64;  ///< Connections beyond the threads, where the library can bound them.
  std::size_t max_body_bytes = 4096;
};

/// What a server shows of itself: the texts of PEM files. TLS 1.3, which every browser since 2020 speaks, and nothing
/// older.
struct HttpTls {
  std::string certificate_pem;
  std::string key_pem;
};

inline constexpr const char* kJsonType = "application/json";
[[nodiscard]] std::string error_json(const Error& error);
/// 400, 404, 429, 502 or 504, by the error's code.
void answer_error(const Error& error, httplib::Response& response);
/// One GET for each file.
void serve_page(httplib::Server& server, std::span<const PageFile> files);

/// Threads: `listen` and a fixed pool; a connection that is silent for some seconds is closed, and larger bodies are
/// refused. Every answer carries a content security policy that allows nothing from elsewhere, and no cache keeps it.
/// Thread-bound.
class HttpServer {
 public:
  /// Port 0 takes a free one. `routes` adds the handlers, which are called on the pool's threads.
  /// kInvalidArgument  as parse_address().     kBusy  the port is taken, or the address is not of this machine.
  /// kBadData  `tls` is no certificate with its key.
  static Result<std::unique_ptr<HttpServer>> start(const std::string& address, const HttpLimits& limits,
                                                   const std::function<void(httplib::Server&)>& routes,
                                                   const std::optional<HttpTls>& tls = std::nullopt);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Waits for handlers that run. Idempotent.
  void stop();

 private:
  explicit HttpServer(std::unique_ptr<httplib::Server> server);
  std::unique_ptr<httplib::Server> server_;
  int port_ = 0;
  std::thread listener_;
};

}  // namespace cyclorama
