// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/page_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include <type_traits>

#include "common/base/text.h"
#include "kiosk/operator/metrics.h"
#include "kiosk/operator/page_files.h"
#include "kiosk/operator/status_json.h"

namespace cyclorama {
namespace {

constexpr std::size_t kThreads = 24;  // A browser holds six connections, each of which occupies one.
constexpr std::size_t kMostWaiting = 64;
constexpr std::size_t kMostBodyBytes = 4096;
constexpr auto kStartsWithin = std::chrono::seconds(5);
constexpr const char* kJson = "application/json";

struct HostAndPort {
  std::string host;
  int port = 0;
};

Result<HostAndPort> parse_address(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  const std::string_view digits = colon == std::string::npos ? "" : std::string_view(address).substr(colon + 1);
  const long long port = parse_integer(digits).value_or(-1);
  std::string host = address.substr(0, std::min(colon, address.size()));
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  const bool bare_ipv6 = !bracketed && host.find(':') != std::string::npos;
  if (port < 0 || port > 65535 || host.empty() || bare_ipv6) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is not an address; write HOST:PORT, such as [::1]:8080", printable(address)));
  }
  return HostAndPort{std::move(host), static_cast<int>(port)};
}

int http_status(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kBadData:
      return 400;
    case ErrorCode::kNotFound:
      return 404;
    case ErrorCode::kTimedOut:
      return 504;
    default:
      return 502;
  }
}

void answer_error(const Error& error, httplib::Response& response) {
  response.status = http_status(error);
  response.set_content(error_json(error), kJson);
}

/// cpp-httplib of Debian 13 can bound its queue of connections, that of Debian 12 cannot.
template <typename Pool>
Pool* make_pool() {
  if constexpr (std::is_constructible_v<Pool, std::size_t, std::size_t>) {
    return new Pool(kThreads, kMostWaiting);
  } else {
    return new Pool(kThreads);
  }
}

void set_limits(httplib::Server& server) {
  server.new_task_queue = [] { return make_pool<httplib::ThreadPool>(); };
  server.set_read_timeout(2);
  server.set_write_timeout(5);
  server.set_keep_alive_timeout(2);
  server.set_keep_alive_max_count(1000);
  server.set_payload_max_length(kMostBodyBytes);
  server.set_tcp_nodelay(true);
  // Instead of httplib's SO_REUSEPORT, with which two operators on one port would share the visitors at random.
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

void serve_page(httplib::Server& server) {
  for (const PageFile& file : page_files()) {
    // The paths hold a dot at most, which matches itself too.
    server.Get(std::string(file.path), [file](const httplib::Request&, httplib::Response& response) {
      response.set_content(file.content.data(), file.content.size(), std::string(file.type));
    });
  }
}

void serve_state(httplib::Server& server, Watch* watch) {
  server.Get("/status", [watch](const httplib::Request&, httplib::Response& response) {
    response.set_content(status_json(watch->observations()), kJson);
  });
  server.Get("/metrics", [watch](const httplib::Request&, httplib::Response& response) {
    response.set_content(metrics_text(watch->observations()), "text/plain; version=0.0.4");
  });
  server.Get(R"(/picture/([^/]+)/(.+)\.jpg)", [watch](const httplib::Request& request, httplib::Response& response) {
    // Bytes that are not UTF-8 may not go on the wire; no picture has a name with a '?' in their place.
    const auto picture = watch->picture(request.matches[1].str(), printable(request.matches[2].str(), 200));
    if (!picture) return answer_error(picture.error(), response);
    response.set_content((*picture)->jpeg(), "image/jpeg");
  });
}

void serve_steering(httplib::Server& server, Watch* watch) {
  server.Post("/steer", [watch](const httplib::Request& request, httplib::Response& response) {
    if (!request.get_header_value("Content-Type").starts_with(kJson)) {
      response.status = 415;
      response.set_content(error_json(Error(ErrorCode::kBadData, "send application/json")), kJson);
      return;
    }
    const auto wish = parse_steer(request.body);
    if (!wish) return answer_error(wish.error(), response);
    if (const Status sent = watch->steer(*wish); !sent) return answer_error(sent.error(), response);
    response.status = 204;
  });
}

void serve_mistakes(httplib::Server& server) {
  server.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
    if (!response.body.empty()) return;
    const std::string what = response.status == 404 ? fmt::format("there is no page '{}'", printable(request.path))
                                                    : "the request was refused";
    response.set_content(error_json(Error(ErrorCode::kNotFound, what)), kJson);
  });
  server.set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
    response.status = 500;
    response.set_content(error_json(Error(ErrorCode::kSystem, "the operator page failed here")), kJson);
  });
}

}  // namespace

PageServer::PageServer() : server_(std::make_unique<httplib::Server>()) {}

Result<std::unique_ptr<PageServer>> PageServer::start(const std::string& address, Watch* watch) {
  TRY_ASSIGN(const HostAndPort place, parse_address(address));
  auto page = std::unique_ptr<PageServer>(new PageServer());
  httplib::Server& server = *page->server_;
  set_limits(server);
  serve_page(server);
  serve_state(server, watch);
  serve_steering(server, watch);
  serve_mistakes(server);
  const bool bound = place.port == 0 ? (page->port_ = server.bind_to_any_port(place.host)) > 0
                                     : server.bind_to_port(place.host, page->port_ = place.port);
  if (!bound) {
    return Error(ErrorCode::kBusy, fmt::format("cannot listen on {}: the port is taken, or the address is not of this "
                                               "machine; stop the other program or choose another",
                                               address));
  }
  page->listener_ = std::thread([&server] { server.listen_after_bind(); });
  // stop() only works on a server that runs, and it tells nobody when it does.
  const TimePoint deadline = SteadyClock().now() + kStartsWithin;
  while (!server.is_running() && SteadyClock().now() < deadline) std::this_thread::yield();
  return page;
}

PageServer::~PageServer() { stop(); }

void PageServer::stop() {
  if (!listener_.joinable()) return;
  server_->stop();
  listener_.join();
}

}  // namespace cyclorama
