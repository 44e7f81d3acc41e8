// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/coordinator_connection.h"

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "common/wire/channel.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/node/tile_sender.h"

namespace cyclorama::node {
namespace {

constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kMaxRetryDelay = std::chrono::seconds(2);
constexpr Duration kStatusPeriod = std::chrono::seconds(1);

using Stream = grpc::ClientReaderWriter<wire::NodeReport, wire::NodeCommand>;

/// Sends until the link closes or finishes, or the stream breaks. A broken stream closes the link, which stops
/// rendering for it.
void send_reports(Stream& stream, NodeLink& link, NodeController& controller) {
  const SteadyClock clock;
  render::Crew& crew = controller.renders().crew();
  TileSender sender(crew);
  TimePoint next_status = clock.now();
  bool fine = true;
  while (fine && !link.is_finished()) {
    std::vector<NodeLink::Outgoing> items;
    auto item = link.pop(next_status);
    while (item) {
      items.push_back(*std::move(item));
      item = items.size() < static_cast<std::size_t>(crew.threads()) ? link.pop(clock.now()) : std::nullopt;
    }
    if (!items.empty()) {
      controller.renders().link_moved();
      for (const wire::NodeReport& report : sender.reports_of(std::move(items))) fine = fine && stream.Write(report);
    }
    if (fine && clock.now() >= next_status) {
      fine = stream.Write(controller.status());
      next_status = clock.now() + kStatusPeriod;
    }
  }
  if (fine && !link.is_closed()) {
    stream.WritesDone();  // The coordinator then ends the stream, which ends the reader.
  } else {
    link.close();
  }
}

}  // namespace

CoordinatorConnection::CoordinatorConnection(std::string address, Channels channels, wire::NodeReport hello,
                                             NodeController& controller)
    : address_(std::move(address)),
      channels_(std::move(channels)),
      hello_(std::move(hello)),
      controller_(controller),
      state_(fmt::format("connecting to the coordinator at {}", address_)),
      thread_([this] { run(); }) {}

CoordinatorConnection::~CoordinatorConnection() { stop(); }

void CoordinatorConnection::finish() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (link_ != nullptr) link_->finish();
  }
  changed_.notify_all();
}

bool CoordinatorConnection::wait_until_ended(TimePoint deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, deadline, [this] { return ended_; });
}

void CoordinatorConnection::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (context_ != nullptr) context_->TryCancel();
    if (link_ != nullptr) link_->close();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::string CoordinatorConnection::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

bool CoordinatorConnection::is_stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

void CoordinatorConnection::set_state(std::string sentence) {
  const std::lock_guard lock(mutex_);
  state_ = std::move(sentence);
}

void CoordinatorConnection::run() {
  Duration delay = kFirstRetry;
  for (bool stopped = false; !stopped;) {
    bool served = false;
    const Error reason = serve(&served);
    delay = served ? kFirstRetry : std::min(2 * delay, kMaxRetryDelay);
    set_state(fmt::format("no coordinator: {}; connecting again", reason.message()));
    wait_until_connected(*channels_.work, delay, [this] { return is_stopping(); });
    stopped = is_stopping();
  }
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
}

Error CoordinatorConnection::serve(bool* ret_served) {
  const auto link = controller_.open(channels_.files);
  const auto stub = wire::Nodes::NewStub(channels_.work);
  grpc::ClientContext context;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) context.TryCancel();
    context_ = &context;
    link_ = link;
  }
  const auto stream = stub->Work(&context);
  Status fine = Done{};
  if (stream->Write(hello_)) {
    std::thread send([&] { send_reports(*stream, *link, controller_); });
    wire::NodeCommand command;
    while (fine && stream->Read(&command)) {
      if (!std::exchange(*ret_served, true)) set_state(fmt::format("serving the coordinator at {}", address_));
      fine = controller_.take(link, command);
    }
    if (!fine) context.TryCancel();
    controller_.close(*link);
    send.join();
  }
  controller_.close(*link);
  const grpc::Status status = finish_after_read(context, [&] { return stream->Finish(); });
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  link_ = nullptr;
  if (!fine) return std::move(fine).error().while_doing(address_);
  return status.ok() ? Error(ErrorCode::kUnavailable, address_ + " ended the stream") : from_grpc(status, address_);
}

}  // namespace cyclorama::node
