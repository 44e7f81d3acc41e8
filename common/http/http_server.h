// SPDX-License-Identifier: Apache-2.0
/// HTTP conventions of this project, based on cpp-httplib: addresses, limits, headers, and errors as {"error":
/// sentence}.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/http/page_file.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace cyclorama {

struct HttpLimits {
  std::size_t threads = 24;           ///< Each whole request occupies one while it is answered.
  std::size_t max_connections = 512;  ///< A browser holds six.
  std::size_t max_body_bytes = 4096;
};

/// Certificate and key of a server, as PEM texts. Only TLS 1.3, which every browser since 2020 supports.
struct HttpTls {
  std::string certificate_pem;
  std::string key_pem;
};

inline constexpr const char* kJsonType = "application/json";
[[nodiscard]] std::string error_json(const Error& error);
/// Answers with 400, 404, 429, 502 or 504, depending on the error's code.
void answer_error(const Error& error, httplib::Response& response);
/// Gives an answer that is an error, but has no sentence yet, one. The server's error handler, unless `routes` sets its own.
void explain_mistake(const httplib::Request& request, httplib::Response& response);
/// Adds a GET handler for each file.
void serve_page(httplib::Server& server, std::span<const PageFile> files);

/// An HTTP server: HttpLoop reads requests and sends answers with deadlines (ConnectionLimits), and cpp-httplib parses
/// and routes those that are whole. Bodies beyond the limit are refused. Every answer has a content security policy
/// that allows nothing from other sources, and forbids caching. Thread-bound.
class HttpServer {
 public:
  /// Starts serving; port 0 selects a free one. `routes` adds the handlers, which are called on the pool's threads.
  /// `clock` is borrowed, and decides deadlines alone. Errors: those of parse_address(); kBusy if the port is taken or
  /// the address is not of this machine; kBadData if `tls` is not a certificate with its key.
  static Result<std::unique_ptr<HttpServer>> start(const std::string& address, const HttpLimits& limits,
                                                   const std::function<void(httplib::Server&)>& routes,
                                                   const std::optional<HttpTls>& tls = std::nullopt,
                                                   const Clock& clock = machine_clock());
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Waits for running handlers. Idempotent.
  void stop();

 private:
  struct Parts;
  HttpServer();
  /// This machine's clock, which lives as long as the program.
  static const Clock& machine_clock();

  std::unique_ptr<Parts> parts_;
  int port_ = 0;
};

}  // namespace cyclorama
