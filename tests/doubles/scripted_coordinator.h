// SPDX-License-Identifier: Apache-2.0
/// A coordinator that sends a test's commands and records the nodes' reports.
#pragma once

#include <grpcpp/server_context.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/channel.h"
#include "common/wire/nodes.grpc.pb.h"

namespace cyclorama {

/// Listens on [::1] from its construction, on a free port or on the given one, so that a test can restart it. Accepts
/// one node at a time. Thread-safe.
class ScriptedCoordinator final : public wire::Nodes::Service {
 public:
  explicit ScriptedCoordinator(int port = 0) {
    auto server = WireServer::start("[::1]:" + std::to_string(port), {this});
    CHECK(server);
    server_ = *std::move(server);
  }
  ~ScriptedCoordinator() override { server_->stop(Duration::zero()); }
  ScriptedCoordinator(const ScriptedCoordinator&) = delete;
  ScriptedCoordinator& operator=(const ScriptedCoordinator&) = delete;

  [[nodiscard]] int port() const { return server_->port(); }
  [[nodiscard]] std::string address() const { return "[::1]:" + std::to_string(port()); }

  /// Sends a command. Precondition: a node is connected.
  void order(const wire::NodeCommand& command) {
    const std::lock_guard lock(mutex_);
    CHECK(stream_ != nullptr);
    stream_->Write(command);
  }
  /// Waits until the predicate is true for all reports so far. Returns false at the deadline.
  bool wait(const std::function<bool(const std::vector<wire::NodeReport>&)>& content,
            Duration limit = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return content(reports_); });
  }
  /// Waits until nodes have ended `streams` streams normally. Returns false at the deadline.
  bool wait_for_ended(int streams, Duration limit = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return ended_ >= streams; });
  }

 private:
  using Stream = grpc::ServerReaderWriter<wire::NodeCommand, wire::NodeReport>;

  grpc::Status Work(grpc::ServerContext* context, Stream* stream) override {
    wire::NodeReport report;
    while (stream->Read(&report)) {
      const std::lock_guard lock(mutex_);
      stream_ = stream;
      reports_.push_back(report);
      changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    stream_ = nullptr;
    if (!context->IsCancelled()) ++ended_;
    changed_.notify_all();
    return grpc::Status::OK;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Stream* stream_ = nullptr;
  std::vector<wire::NodeReport> reports_;
  int ended_ = 0;

  std::unique_ptr<WireServer> server_;
};

}  // namespace cyclorama
