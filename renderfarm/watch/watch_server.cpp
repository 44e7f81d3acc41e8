// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/watch_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <thread>

#include "common/base/text.h"
#include "common/image/jpeg.h"
#include "renderfarm/watch/mjpeg.h"
#include "renderfarm/watch/status_json.h"
#include "renderfarm/watch/watch_page.h"

namespace cyclorama::watch {
namespace {

constexpr HttpLimits kLimits{.threads = 12};
/// Minimum time between two pictures for one watcher; ten per second suffice to judge them.
constexpr Duration kPeriod = std::chrono::milliseconds(100);
/// Time after which a picture at rest is sent again, so that disconnected watchers are noticed and players stay
/// connected.
constexpr Duration kAgain = std::chrono::seconds(4);
/// Maximum time that a handler waits in one call, so that it notices stop().
constexpr Duration kWaitTimeout = std::chrono::seconds(1);
constexpr JpegOptions kJpeg{80, true};

Result<std::vector<std::byte>> encoded(const FramePicture& frame, bool half) {
  TRY_ASSIGN(const RgbImage picture, composed(frame));
  return JpegEncoder().encode(half ? halved(picture) : picture, kJpeg);
}

Error no_such_session(std::uint64_t session) {
  return Error(ErrorCode::kNotFound, fmt::format("session {} is not open, or has no picture yet", session));
}

/// One watcher of one session; sends the next picture at each call.
class Watcher {
 public:
  Watcher(const SessionPictures& pictures, std::uint64_t session, bool half, std::atomic<int>& watchers)
      : pictures_(pictures), session_(session), half_(half), watchers_(watchers) {}
  ~Watcher() { --watchers_; }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  /// Returns false if the watcher has left or the picture cannot be shown.
  bool send_next(httplib::DataSink& sink) {
    if (last_ == nullptr && !write(sink, mjpeg_begin())) return false;
    const SteadyClock clock;
    clock.wait_until(sent_at_ + kPeriod);
    const TimePoint again = last_ == nullptr ? TimePoint::max() : sent_at_ + kAgain;
    std::shared_ptr<const FramePicture> next;
    while (next == nullptr && clock.now() < again && pictures_.is_open(session_)) {
      next =
          pictures_.newest(session_, last_ == nullptr ? 0 : last_->serial, std::min(again, clock.now() + kWaitTimeout));
    }
    if (!pictures_.is_open(session_)) {
      sink.done();
      return true;
    }
    if (next != nullptr) {
      const auto jpeg = encoded(*next, half_);
      if (!jpeg) return false;
      part_ = mjpeg_part(*jpeg);
      last_ = std::move(next);
    }
    sent_at_ = clock.now();
    return write(sink, part_);
  }

 private:
  static bool write(httplib::DataSink& sink, const std::string& bytes) {
    return sink.write(bytes.data(), bytes.size());
  }

  const SessionPictures& pictures_;
  const std::uint64_t session_;
  const bool half_;
  std::atomic<int>& watchers_;
  std::shared_ptr<const FramePicture> last_{};
  std::string part_{};
  TimePoint sent_at_{};
};

}  // namespace

Result<std::unique_ptr<WatchServer>> WatchServer::start(const std::string& address, Access access, Sources sources) {
  auto watch = std::unique_ptr<WatchServer>(new WatchServer(std::move(access), std::move(sources)));
  TRY_ASSIGN(watch->http_,
             HttpServer::start(address, kLimits, [&](httplib::Server& server) { watch->add_routes(server); }));
  return watch;
}

WatchServer::~WatchServer() { stop(); }

void WatchServer::stop() {
  sources_.pictures.close();
  if (http_ != nullptr) http_->stop();
}

bool WatchServer::turn_away(const httplib::Request& request, httplib::Response& response) const {
  if (request.path == "/health") return false;
  if (access_.admits(request.get_header_value("Authorization"), request.get_header_value("Host"))) return false;
  Error error(ErrorCode::kInvalidArgument, "this page is for this machine only; open it at [::1] or localhost");
  response.status = 403;
  if (access_.has_token()) {
    response.status = 401;
    response.set_header("WWW-Authenticate", "Basic realm=\"cyclorama-farm\", charset=\"UTF-8\"");
    error = Error(ErrorCode::kInvalidArgument,
                  fmt::format("give the token, as Bearer or as the password of '{}'", Access::kUser));
  }
  response.set_content(error_json(error), kJsonType);
  return true;
}

void WatchServer::answer_picture(std::uint64_t session, bool half, httplib::Response& response) const {
  const auto frame = sources_.pictures.newest(session, 0, SteadyClock().now());
  if (frame == nullptr) return answer_error(no_such_session(session), response);
  const auto jpeg = encoded(*frame, half);
  if (!jpeg) return answer_error(jpeg.error(), response);
  response.set_content(reinterpret_cast<const char*>(jpeg->data()), jpeg->size(), "image/jpeg");
}

void WatchServer::answer_pictures(std::uint64_t session, bool half, httplib::Response& response) {
  if (!sources_.pictures.is_open(session)) return answer_error(no_such_session(session), response);
  if (++watchers_ > kMaxWatchers) {
    --watchers_;
    return answer_error(Error(ErrorCode::kBusy, fmt::format("{} watch already; close one", kMaxWatchers)), response);
  }
  const auto watcher = std::make_shared<Watcher>(sources_.pictures, session, half, watchers_);
  // For a HEAD request or a broken connection the provider is never called. It is destroyed at the end of the response.
  response.set_chunked_content_provider(
      kMjpegType, [watcher](std::size_t, httplib::DataSink& sink) { return watcher->send_next(sink); });
}

void WatchServer::add_routes(httplib::Server& server) {
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    return turn_away(request, response) ? httplib::Server::HandlerResponse::Handled
                                        : httplib::Server::HandlerResponse::Unhandled;
  });
  serve_page(server, watch_page_files());
  server.Get("/status", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(status_json(sources_.status()), kJsonType);
  });
  server.Get("/sessions", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(table_json(sources_.status(), "sessions"), kJsonType);
  });
  server.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(sources_.metrics.text(), kMetricsType);
  });
  server.Get("/health", [this](const httplib::Request&, httplib::Response& response) {
    const bool healthy = sources_.status().healthy();
    response.status = healthy ? 200 : 503;
    response.set_content(healthy ? "{\"healthy\": true}\n" : "{\"healthy\": false}\n", kJsonType);
  });
  server.Get(R"(/sessions/(\d{1,18})\.(mjpeg|jpg))",
             [this](const httplib::Request& request, httplib::Response& response) {
               const auto session = static_cast<std::uint64_t>(parse_integer(request.matches[1].str()).value_or(0));
               const bool half = request.has_param("half");
               if (request.matches[2] == "jpg") return answer_picture(session, half, response);
               answer_pictures(session, half, response);
             });
}

}  // namespace cyclorama::watch
