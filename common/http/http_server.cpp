// SPDX-License-Identifier: Apache-2.0
#include "common/http/http_server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <httplib.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/base/address.h"
#include "common/base/text.h"
#include "common/base/unique_fd.h"
#include "common/http/answer_buffer.h"
#include "common/http/http_loop.h"

namespace cyclorama {
namespace {

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

/// The routes of cpp-httplib without its way to serve sockets, which gives each connection a thread, however slow its
/// client is.
class Router final : public httplib::Server {
 public:
  /// Answers one whole request. Returns whether the connection is to be closed.
  bool answer(httplib::Stream& stream, const std::string& peer) {
    bool closes = false;
    const auto nothing = [](httplib::Request&) {};
    // The library of Debian 13 takes addresses as arguments; that of Debian 12 requests them from the stream.
    const auto processed = [&](auto& self) {
      if constexpr (requires { self.process_request(stream, false, closes, nothing); }) {
        return self.process_request(stream, false, closes, nothing);
      } else {
        return self.process_request(stream, peer, 0, std::string(), 0, false, closes, nothing);
      }
    };
    return !processed(*this) || closes;
  }
  /// Returns the socket of bind_to_port(). The server keeps its number, by which streamed answers see that it runs.
  [[nodiscard]] UniqueFd listener() const { return UniqueFd(::fcntl(svr_sock_, F_DUPFD_CLOEXEC, 0)); }
  /// Ends streamed answers. Idempotent.
  void close() {
    if (const socket_t socket = svr_sock_.exchange(INVALID_SOCKET); socket != INVALID_SOCKET) ::close(socket);
  }
  ~Router() override { close(); }
};

/// A whole request as cpp-httplib reads it, and its answer as cpp-httplib writes it.
class MemoryStream final : public httplib::Stream {
 public:
  /// Both are borrowed.
  MemoryStream(const HttpLoop::Request& request, AnswerBuffer* answer)
      : rest_(request.bytes), peer_(request.peer), answer_(answer) {}
  [[nodiscard]] bool is_readable() const override { return !rest_.empty(); }
  [[nodiscard]] bool is_writable() const override { return is_open_; }
  ssize_t read(char* bytes, std::size_t size) override {
    const std::size_t count = rest_.copy(bytes, size);
    rest_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    is_open_ = answer_->append({bytes, size});
    return is_open_ ? static_cast<ssize_t>(size) : -1;
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = peer_;
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip.clear();
    port = 0;
  }
  [[nodiscard]] socket_t socket() const override { return INVALID_SOCKET; }

 private:
  std::string_view rest_;
  const std::string& peer_;
  AnswerBuffer* const answer_;
  bool is_open_ = true;
};

void set_limits(httplib::Server& server, const HttpLimits& limits) {
  server.set_keep_alive_max_count(1000);
  server.set_payload_max_length(limits.max_body_bytes);
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
  server.set_error_handler(explain_mistake);
  server.set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
    response.status = 500;
    response.set_content(error_json(Error(ErrorCode::kSystem, "the page failed here")), kJsonType);
  });
}

using Bio = std::unique_ptr<BIO, decltype([](BIO* bio) { BIO_free(bio); })>;
using Certificate = std::unique_ptr<X509, decltype([](X509* certificate) { X509_free(certificate); })>;
using Key = std::unique_ptr<EVP_PKEY, decltype([](EVP_PKEY* key) { EVP_PKEY_free(key); })>;

Bio bio_of(const std::string& text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

using TlsContext = std::unique_ptr<SSL_CTX, decltype([](SSL_CTX* context) { SSL_CTX_free(context); })>;

Result<TlsContext> make_context(const HttpTls& tls) {
  TlsContext context(SSL_CTX_new(TLS_server_method()));
  const Certificate certificate(PEM_read_bio_X509(bio_of(tls.certificate_pem).get(), nullptr, nullptr, nullptr));
  const auto no_pass_phrase = [](char*, int, int, void*) { return -1; };
  const Key key(PEM_read_bio_PrivateKey(bio_of(tls.key_pem).get(), nullptr, no_pass_phrase, nullptr));
  const bool is_good =
      context && certificate && key && SSL_CTX_set_min_proto_version(context.get(), TLS1_3_VERSION) == 1 &&
      SSL_CTX_use_certificate(context.get(), certificate.get()) == 1 &&
      SSL_CTX_use_PrivateKey(context.get(), key.get()) == 1 && SSL_CTX_check_private_key(context.get()) == 1;
  if (is_good) return context;
  return Error(ErrorCode::kBadData,
               "the page's certificate and key do not belong together; remove both, new ones are "
               "made at the next start");
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

void explain_mistake(const httplib::Request& request, httplib::Response& response) {
  if (!response.body.empty()) return;
  const std::string what = response.status == 404 ? fmt::format("there is no page '{}'", printable(request.path))
                                                  : "the request was refused";
  response.set_content(error_json(Error(ErrorCode::kNotFound, what)), kJsonType);
}

void serve_page(httplib::Server& server, std::span<const PageFile> files) {
  for (const PageFile& file : files) {
    // httplib takes paths as regular expressions; their only special character is a dot, which also matches itself.
    server.Get(std::string(file.path), [file](const httplib::Request&, httplib::Response& response) {
      response.set_content(file.content.data(), file.content.size(), std::string(file.type));
    });
  }
}

/// In the order of their dependence: the loop ends first.
struct HttpServer::Parts {
  Router router;
  TlsContext context;
  std::unique_ptr<HttpLoop> loop;
};

HttpServer::HttpServer() : parts_(std::make_unique<Parts>()) {}

const Clock& HttpServer::machine_clock() {
  static const SteadyClock clock;
  return clock;
}

Result<std::unique_ptr<HttpServer>> HttpServer::start(const std::string& address, const HttpLimits& limits,
                                                      const std::function<void(httplib::Server&)>& routes,
                                                      const std::optional<HttpTls>& tls, const Clock& clock) {
  TRY_ASSIGN(const Address place, parse_address(address));
  auto page = std::unique_ptr<HttpServer>(new HttpServer());
  if (tls) {
    TRY_ASSIGN(page->parts_->context, make_context(*tls));
  }
  Router& router = page->parts_->router;
  set_limits(router, limits);
  serve_mistakes(router);
  routes(router);
  const bool bound = place.port == 0 ? (page->port_ = router.bind_to_any_port(place.host)) > 0
                                     : router.bind_to_port(place.host, page->port_ = place.port);
  UniqueFd listener = bound ? router.listener() : UniqueFd();
  // The library's backlog of five would drop clients whenever more than that connect at once.
  if (!listener.is_open() || ::fcntl(listener.get(), F_SETFL, O_NONBLOCK) != 0 ||
      ::listen(listener.get(), SOMAXCONN) != 0) {
    return Error(ErrorCode::kBusy, fmt::format("cannot listen on {}: the port is taken, or the address is not of this "
                                               "machine; stop the other program or choose another",
                                               address));
  }
  HttpLoop::Options options;
  options.threads = limits.threads;
  options.max_connections = limits.max_connections;
  options.connection.max_body_bytes = limits.max_body_bytes;
  const auto answer = [&router](const HttpLoop::Request& request, AnswerBuffer& buffer) {
    MemoryStream stream(request, &buffer);
    return router.answer(stream, request.peer);
  };
  page->parts_->loop =
      std::make_unique<HttpLoop>(std::move(listener), page->parts_->context.get(), options, answer, clock);
  return page;
}

HttpServer::~HttpServer() { stop(); }

void HttpServer::stop() {
  parts_->router.close();
  parts_->loop.reset();
}

}  // namespace cyclorama
