// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/farm_client.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <optional>

#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"

namespace cyclorama {
namespace {
constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kSlowestRetry = std::chrono::seconds(2);
}  // namespace

/// One session's call. The farm thread reads from it, the views thread writes to it.
class FarmClient::Visit {
 public:
  explicit Visit(const std::shared_ptr<grpc::Channel>& channel)
      : stub_(wire::Farm::NewStub(channel)), stream_(stub_->Visit(&context)) {}
  [[nodiscard]] auto& stream() { return *stream_; }

  grpc::ClientContext context;
  bool over = false;                ///< Guarded by the client's mutex_.
  std::optional<Error> given_up{};  ///< Guarded by the client's mutex_.

 private:
  std::unique_ptr<wire::Farm::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::VisitRequest, wire::VisitReply>> stream_;
};

Result<std::unique_ptr<FarmClient>> FarmClient::start(FarmClientOptions options, FarmListener& listener) {
  if (options.heads.empty()) return Error(ErrorCode::kInvalidArgument, "no address of a farm is given");
  std::vector<std::shared_ptr<grpc::Channel>> channels;
  for (const std::string& head : options.heads) {
    TRY_ASSIGN(auto channel, make_channel(head, options.tls));
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
  for (std::size_t head = 0;; head = (head + 1) % channels_.size()) {
    bool opened = false;
    const Error reason = visit(channels_[head], &opened);
    lose(std::move(Error(reason)).while_doing(options_.heads[head]));
    if (opened) {
      // The session had been open, so the same coordinator is tried first, after the shortest delay.
      delay = kFirstRetry;
      head = (head + channels_.size() - 1) % channels_.size();
    }
    if (!wait_before_retry(delay, *channels_[(head + 1) % channels_.size()])) return;
    if (!opened && head + 1 == channels_.size()) delay = std::min(2 * delay, kSlowestRetry);
  }
}

bool FarmClient::wait_before_retry(Duration delay, grpc::Channel& next) {
  const auto is_stopping = [this] {
    const std::lock_guard lock(mutex_);
    return stopping_;
  };
  wait_dialling(next, delay, is_stopping);
  return !is_stopping();
}

Error FarmClient::visit(const std::shared_ptr<grpc::Channel>& channel, bool* ret_opened) {
  Visit visit(channel);
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) visit.context.TryCancel();
    context_ = &visit.context;
    heard_at_ = SteadyClock().now();
  }
  std::thread views([&] { write_views(visit); });
  wire::VisitReply reply;
  Status fine = Done{};
  while (fine && visit.stream().Read(&reply)) fine = handle(reply, ret_opened);
  if (!fine) visit.context.TryCancel();
  {
    const std::lock_guard lock(mutex_);
    visit.over = true;
  }
  changed_.notify_all();
  views.join();
  const grpc::Status status = finish_after_read(visit.context, [&] { return visit.stream().Finish(); });
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  if (!fine) return std::move(fine).error();
  if (visit.given_up) return *visit.given_up;
  return status.ok() ? Error(ErrorCode::kUnavailable, "the farm ended the visit") : from_grpc(status, "visiting");
}

void FarmClient::write_views(Visit& visit) {
  wire::VisitRequest request;
  request.mutable_open()->set_scene(options_.scene);
  request.mutable_open()->set_museum(options_.museum);
  request.mutable_open()->set_frame_budget_ms(options_.frame_budget_ms);
  request.mutable_open()->set_reference_samples(static_cast<std::uint32_t>(options_.reference_samples));
  bool alive = visit.stream().Write(request);
  std::unique_lock lock(mutex_);
  while (alive && !visit.over) {
    if (window_.is_sendable()) {
      if (window_.in_flight() == 0) heard_at_ = SteadyClock().now();
      *request.mutable_view() = *window_.take_sendable();
      lock.unlock();
      alive = visit.stream().Write(request);
      lock.lock();
      continue;
    }
    const bool owes = !window_.is_opened() || window_.in_flight() > 0;
    const TimePoint until = owes ? heard_at_ + options_.patience : SteadyClock().now() + options_.patience;
    if (owes && SteadyClock().now() >= until) {
      visit.given_up =
          Error(ErrorCode::kTimedOut, fmt::format("the farm said nothing for {:.0f} s", to_seconds(options_.patience)));
      visit.context.TryCancel();
      return;
    }
    changed_.wait_until(lock, until);
  }
}

Status FarmClient::handle(const wire::VisitReply& reply, bool* ret_opened) {
  {
    const std::lock_guard lock(mutex_);
    heard_at_ = SteadyClock().now();
    TRY(window_.take(reply));
  }
  switch (reply.message_case()) {
    case wire::VisitReply::kOpened:
      *ret_opened = true;
      last_reason_.clear();
      listener_.on_opened(reply.opened());
      changed_.notify_all();
      break;
    case wire::VisitReply::kBegin:
      listener_.on_begin(reply.begin());
      break;
    case wire::VisitReply::kTile:
      listener_.on_tile(reply.tile());
      break;
    case wire::VisitReply::kEnd:
      listener_.on_end(reply.end());
      changed_.notify_all();
      break;
    case wire::VisitReply::MESSAGE_NOT_SET:
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

}  // namespace cyclorama
