// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include <nlohmann/json.hpp>
#include <type_traits>

#include "common/base/address.h"
#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr auto kStartsWithin = std::chrono::seconds(5);

int http_status(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kBadData:
      return 400;
    case ErrorCode::kNotFound:
      return 404;
    case ErrorCode::kBusy:
      return 429;
    case ErrorCode::kTimedOut:
      return 504;
    default:
      return 502;
  }
}

/// Makes a pool of threads. cpp-httplib of Debian 13 can limit its queue of connections; that of Debian 12 cannot.
template <typename Pool>
Pool* make_pool(const HttpLimits& limits) {
  if constexpr (std::is_constructible_v<Pool, std::size_t, std::size_t>) {
    return new Pool(limits.threads, limits.max_waiting);
  } else {
    return new Pool(limits.threads);
  }
}

void set_limits(httplib::Server& server, const HttpLimits& limits) {
  server.new_task_queue = [limits] { return make_pool<httplib::ThreadPool>(limits); };
  server.set_read_timeout(2);
  server.set_write_timeout(5);
  server.set_keep_alive_timeout(2);
  server.set_keep_alive_max_count(1000);
  server.set_payload_max_length(limits.max_body_bytes);
  server.set_tcp_nodelay(true);
  // Replaces httplib's SO_REUSEPORT, which would distribute visitors at random between two servers on one port.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Content-Security-Policy",
                               "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
                               "connect-src 'self'; base-uri 'none'; frame-ancestors 'none'"}});
}

void serve_mistakes(httplib::Server& server) {
  server.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
    if (!response.body.empty()) return;
    const std::string what = response.status == 404 ? fmt::format("there is no page '{}'", printable(request.path))
                                                    : "the request was refused";
    response.set_content(error_json(Error(ErrorCode::kNotFound, what)), kJsonType);
  });
  server.set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
    response.status = 500;
    response.set_content(error_json(Error(ErrorCode::kSystem, "the page failed here")), kJsonType);
  });
}

using Bio = std::unique_ptr<BIO, decltype([](BIO* bio) { BIO_free(bio); })>;
using Certificate = std::unique_ptr<X509, decltype([](X509* certificate) { X509_free(certificate); })>;
using Key = std::unique_ptr<EVP_PKEY, decltype([](EVP_PKEY* key) { EVP_PKEY_free(key); })>;

Bio bio_of(const std::string& text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

bool use(const HttpTls& tls, SSL_CTX* context) {
  const Certificate certificate(PEM_read_bio_X509(bio_of(tls.certificate_pem).get(), nullptr, nullptr, nullptr));
  const auto no_pass_phrase = [](char*, int, int, void*) { return -1; };
  const Key key(PEM_read_bio_PrivateKey(bio_of(tls.key_pem).get(), nullptr, no_pass_phrase, nullptr));
  return certificate && key && SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION) == 1 &&
         SSL_CTX_use_certificate(context, certificate.get()) == 1 && SSL_CTX_use_PrivateKey(context, key.get()) == 1 &&
         SSL_CTX_check_private_key(context) == 1;
}

Result<std::unique_ptr<httplib::Server>> make_server(const std::optional<HttpTls>& tls) {
  if (!tls) return std::make_unique<httplib::Server>();
  std::unique_ptr<httplib::Server> server =
      std::make_unique<httplib::SSLServer>([&](SSL_CTX& context) { return use(*tls, &context); });
  if (!server->is_valid()) {
    return Error(ErrorCode::kBadData,
                 "the page's certificate and key do not belong together; remove both, new ones are "
                 "made at the next start");
  }
  return server;
}

}  // namespace

std::string error_json(const Error& error) {
  // Bytes that are not UTF-8 are replaced, so that a peer's text cannot break a page.
  return nlohmann::json{{"error", error.message()}}.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void answer_error(const Error& error, httplib::Response& response) {
  response.status = http_status(error);
  response.set_content(error_json(error), kJsonType);
}

void serve_page(httplib::Server& server, std::span<const PageFile> files) {
  for (const PageFile& file : files) {
    // httplib takes paths as regular expressions; their only special character is a dot, which also matches itself.
    server.Get(std::string(file.path), [file](const httplib::Request&, httplib::Response& response) {
      response.set_content(file.content.data(), file.content.size(), std::string(file.type));
    });
  }
}

HttpServer::HttpServer(std::unique_ptr<httplib::Server> server) : server_(std::move(server)) {}

Result<std::unique_ptr<HttpServer>> HttpServer::start(const std::string& address, const HttpLimits& limits,
                                                      const std::function<void(httplib::Server&)>& routes,
                                                      const std::optional<HttpTls>& tls) {
  TRY_ASSIGN(const Address place, parse_address(address));
  TRY_ASSIGN(std::unique_ptr<httplib::Server> made, make_server(tls));
  auto page = std::unique_ptr<HttpServer>(new HttpServer(std::move(made)));
  httplib::Server& server = *page->server_;
  set_limits(server, limits);
  routes(server);
  serve_mistakes(server);
  const bool bound = place.port == 0 ? (page->port_ = server.bind_to_any_port(place.host)) > 0
                                     : server.bind_to_port(place.host, page->port_ = place.port);
  if (!bound) {
    return Error(ErrorCode::kBusy, fmt::format("cannot listen on {}: the port is taken, or the address is not of this "
                                               "machine; stop the other program or choose another",
                                               address));
  }
  page->listener_ = std::thread([&server] { server.listen_after_bind(); });
  // stop() works only on a running server, and httplib does not report the start.
  const TimePoint deadline = SteadyClock().now() + kStartsWithin;
  while (!server.is_running() && SteadyClock().now() < deadline) std::this_thread::yield();
  return page;
}

HttpServer::~HttpServer() { stop(); }

void HttpServer::stop() {
  if (!listener_.joinable()) return;
  server_->stop();
  listener_.join();
}

}  // namespace cyclorama
