// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/farm_client.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <optional>

#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"

namespace cyclorama::client {
namespace {
constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kMaxRetryDelay = std::chrono::milliseconds(500);
}  // namespace

/// The call of one session. The farm thread reads from it; the views thread writes to it.
class FarmClient::Session {
 public:
  explicit Session(const std::shared_ptr<grpc::Channel>& channel)
      : stub_(wire::Farm::NewStub(channel)), stream_(stub_->Session(&context)) {}
  [[nodiscard]] auto& stream() { return *stream_; }

  grpc::ClientContext context;
  bool over = false;                ///< Guarded by the client's mutex_.
  std::optional<Error> given_up{};  ///< Guarded by the client's mutex_.

 private:
  std::unique_ptr<wire::Farm::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::SessionRequest, wire::SessionReply>> stream_;
};

Result<std::unique_ptr<FarmClient>> FarmClient::start(FarmClientOptions options, FarmListener& listener) {
  if (options.coordinators.empty()) return Error(ErrorCode::kInvalidArgument, "no address of a farm is given");
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  for (const std::string& coordinator : options.coordinators) {
    TRY_ASSIGN(auto channel, make_channel(coordinator, options.tls));
    channels.push_back(std::move(channel));
  }
  return std::unique_ptr<FarmClient>(new FarmClient(std::move(options), std::move(channels), listener));
}

FarmClient::FarmClient(FarmClientOptions options, std::vector<std::shared_ptr<grpc::Channel>> channels,
                       FarmListener& listener)
    : options_(std::move(options)), channels_(std::move(channels)), listener_(listener), farm_([this] { run(); }) {}

FarmClient::~FarmClient() { stop(); }

void FarmClient::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (context_ != nullptr) context_->TryCancel();
  }
  changed_.notify_all();
  if (farm_.joinable()) farm_.join();
}

bool FarmClient::request(wire::View view) {
  bool dropped = false;
  {
    const std::lock_guard lock(mutex_);
    dropped = window_.put(std::move(view));
  }
  changed_.notify_all();
  return dropped;
}

void FarmClient::run() {
  Duration delay = kFirstRetry;
  for (std::size_t coordinator = 0;; coordinator = (coordinator + 1) % channels_.size()) {
    bool opened = false;
    const Error reason = session(channels_[coordinator], &opened);
    lose(std::move(Error(reason)).while_doing(options_.coordinators[coordinator]));
    if (opened) {
      // The session was open, so the same coordinator is tried first, after the minimum delay.
      delay = kFirstRetry;
      coordinator = (coordinator + channels_.size() - 1) % channels_.size();
    }
    if (!wait_before_retry(delay, *channels_[(coordinator + 1) % channels_.size()])) return;
    if (!opened && coordinator + 1 == channels_.size()) delay = std::min(2 * delay, kMaxRetryDelay);
  }
}

bool FarmClient::wait_before_retry(Duration delay, grpc::Channel& next) {
  const auto is_stopping = [this] {
    const std::lock_guard lock(mutex_);
    return stopping_;
  };
  wait_until_connected(next, delay, is_stopping);
  return !is_stopping();
}

Error FarmClient::session(const std::shared_ptr<grpc::Channel>& channel, bool* ret_opened) {
  Session session(channel);
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) session.context.TryCancel();
    context_ = &session.context;
    heard_at_ = SteadyClock().now();
  }
  std::thread views([&] { write_views(session); });
  wire::SessionReply reply;
  Status fine = Done{};
  while (fine && session.stream().Read(&reply)) fine = handle(reply, ret_opened);
  if (!fine) session.context.TryCancel();
  {
    const std::lock_guard lock(mutex_);
    session.over = true;
  }
  changed_.notify_all();
  views.join();
  const grpc::Status status = finish_after_read(session.context, [&] { return session.stream().Finish(); });
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  if (!fine) return std::move(fine).error();
  if (session.given_up) return *session.given_up;
  return status.ok() ? Error(ErrorCode::kUnavailable, "the farm ended the session") : from_grpc(status, "visiting");
}

void FarmClient::write_views(Session& session) {
  wire::SessionRequest request;
  request.mutable_open()->set_scene(options_.scene);
  request.mutable_open()->set_museum(options_.museum);
  request.mutable_open()->set_frame_budget_ms(options_.frame_budget_ms);
  request.mutable_open()->set_reference_samples(static_cast<std::uint32_t>(options_.reference_samples));
  bool alive = session.stream().Write(request);
  std::unique_lock lock(mutex_);
  while (alive && !session.over) {
    if (window_.is_sendable()) {
      if (window_.in_flight() == 0) heard_at_ = SteadyClock().now();
      *request.mutable_view() = *window_.take_sendable();
      lock.unlock();
      alive = session.stream().Write(request);
      lock.lock();
      continue;
    }
    const bool awaits_answer = !window_.is_opened() || window_.in_flight() > 0;
    const TimePoint until = awaits_answer ? heard_at_ + options_.timeout : SteadyClock().now() + options_.timeout;
    if (awaits_answer && SteadyClock().now() >= until) {
      session.given_up = Error(ErrorCode::kTimedOut,
                               fmt::format("the farm did not answer for {:.0f} s", to_seconds(options_.timeout)));
      session.context.TryCancel();
      return;
    }
    changed_.wait_until(lock, until);
  }
}

Status FarmClient::handle(const wire::SessionReply& reply, bool* ret_opened) {
  {
    const std::lock_guard lock(mutex_);
    heard_at_ = SteadyClock().now();
    TRY(window_.take(reply));
  }
  switch (reply.message_case()) {
    case wire::SessionReply::kOpened:
      *ret_opened = true;
      last_reason_.clear();
      listener_.on_opened(reply.opened());
      changed_.notify_all();
      break;
    case wire::SessionReply::kBegin:
      listener_.on_begin(reply.begin());
      break;
    case wire::SessionReply::kTile:
      listener_.on_tile(reply.tile());
      break;
    case wire::SessionReply::kEnd:
      listener_.on_end(reply.end());
      changed_.notify_all();
      break;
    case wire::SessionReply::MESSAGE_NOT_SET:
      break;
  }
  return Done{};
}

void FarmClient::lose(const Error& reason) {
  std::optional<std::uint64_t> open_number;
  {
    const std::lock_guard lock(mutex_);
    open_number = window_.lose();
    if (stopping_) return;
  }
  if (open_number) {
    wire::FrameEnd end;
    end.set_view_number(*open_number);
    end.set_complete(false);
    end.set_reason(reason.message());
    listener_.on_end(end);
  }
  if (reason.message() == last_reason_) return;
  last_reason_ = reason.message();
  listener_.on_lost(reason);
}

}  // namespace cyclorama::client
