// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/channel.h"
#include "common/wire/museum.grpc.pb.h"

namespace cyclorama::display {

/// One call of Tour.Show, from the connection to its end. A new call needs a new object. Thread-safe, except for
/// destruction.
class ShowStream : private grpc::ClientBidiReactor<wire::DisplayReport, wire::ShowMessage> {
 public:
  using Listener = std::function<void(wire::ShowMessage)>;

  /// Sends `hello`. `listener` is called on gRPC's threads, one message at a time, until the destructor returns.
  ShowStream(const std::shared_ptr<grpc::Channel>& channel, const wire::DisplayHello& hello, Listener listener);
  /// Cancels the call, and waits until the last call of the listener has returned.
  ~ShowStream() override;
  ShowStream(const ShowStream&) = delete;
  ShowStream& operator=(const ShowStream&) = delete;

  /// Queues `report` and sends it when the connection is ready; never blocks. Drops it if 256 reports are queued
  /// already, or if the stream is over.
  void report(wire::DisplayReport report);

  /// True once the tour has answered.
  [[nodiscard]] bool is_up() const;
  /// Returns why the stream is over; empty while it is not. Must be called regularly: it also ends a stream on which
  /// the tour sent an invalid message.
  [[nodiscard]] std::optional<Error> end();

 private:
  void OnReadInitialMetadataDone(bool ok) override;
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;
  void write_next();  // Precondition: mutex_ is held.

  std::unique_ptr<wire::Tour::Stub> stub_;
  const Listener listener_;
  grpc::ClientContext context_;
  wire::ShowMessage message_;  // Buffer that gRPC reads into.

  std::mutex listening_;  // Held while the listener runs, since gRPC does not guarantee an order between its threads.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<wire::DisplayReport> reports_;  // The first report is being written while is_writing_.
  bool is_writing_ = false;
  bool is_up_ = false;
  bool is_ending_ = false;  // No new write may start.
  std::optional<TimePoint> read_failed_at_;
  bool is_given_up_ = false;
  std::optional<Error> end_;
};

}  // namespace cyclorama::display
