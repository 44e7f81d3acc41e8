// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/support/server_callback.h>

#include <deque>
#include <memory>
#include <mutex>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::coordinator {

/// Callbacks from a stream to its owner, called on gRPC's threads. They must return at once.
template <typename In, typename Out>
class PeerStreamEvents {
 public:
  virtual ~PeerStreamEvents() = default;
  /// Called for one message at a time; the next call comes only after read_next().
  virtual void on_read(std::uint64_t id, In message) = 0;
  virtual void on_written(std::uint64_t id, Out message) = 0;
  /// Called when the peer has half-closed the stream or is gone. finish() must follow.
  virtual void on_closed(std::uint64_t id) = 0;
  /// Called last.
  virtual void on_done(std::uint64_t id) = 0;

 protected:
  PeerStreamEvents() = default;
  PeerStreamEvents(const PeerStreamEvents&) = default;
  PeerStreamEvents& operator=(const PeerStreamEvents&) = default;
};

/// One open call of a peer. Messages are read one by one as the owner requests, and written through a queue. The stream
/// keeps itself alive until gRPC is done with it. The owner may hold it longer, but calls then have no effect.
/// Thread-safe.
template <typename In, typename Out>
class PeerStream final : public grpc::ServerBidiReactor<In, Out> {
 public:
  /// Opens a stream and begins to read the first message. `events` is borrowed until on_done().
  static std::shared_ptr<PeerStream> open(std::uint64_t id, grpc::CallbackServerContext* context,
                                          PeerStreamEvents<In, Out>& events) {
    std::shared_ptr<PeerStream> stream(new PeerStream(id, context, events));
    stream->self_ = stream;
    return stream;
  }

  void read_next() {
    const std::lock_guard lock(mutex_);
    if (!finished_) this->StartRead(&in_);
  }

  /// Queues a message without a limit; the sender must bound the queue by counting on_written().
  void send(Out message) {
    const std::lock_guard lock(mutex_);
    if (ending_ || finished_) return;
    queue_.push_back(std::move(message));
    if (!writing_) write_front();
  }

  /// Ends the call: at once, or after the queued messages. If called repeatedly, the first status is used.
  void finish(grpc::Status status, bool at_once) {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(ending_, true)) status_ = std::move(status);
    if (at_once && !done_) {
      // Cancellation is the only way to end a write to a peer that does not read.
      if (writing_) context_->TryCancel();
      queue_.erase(queue_.begin() + (writing_ ? 1 : 0), queue_.end());
    }
    finish_if_idle();
  }

 private:
  PeerStream(std::uint64_t id, grpc::CallbackServerContext* context, PeerStreamEvents<In, Out>& events)
      : id_(id), context_(context), events_(events) {}

  void OnReadDone(bool ok) override {
    In message;
    {
      const std::lock_guard lock(mutex_);
      if (ok) std::swap(message, in_);
    }
    if (!ok) return events_.on_closed(id_);
    events_.on_read(id_, std::move(message));
  }

  void OnWriteDone(bool ok) override {
    Out message;
    {
      const std::lock_guard lock(mutex_);
      message = std::move(queue_.front());
      queue_.pop_front();
      writing_ = false;
      if (!ok) queue_.clear();  // The peer is gone; on_closed() reports it.
      if (!queue_.empty()) write_front();
      finish_if_idle();
    }
    if (ok) events_.on_written(id_, std::move(message));
  }

  void OnDone() override {
    std::shared_ptr<PeerStream> self;
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
      self = std::move(self_);
    }
    events_.on_done(id_);
  }

  void write_front() {
    writing_ = true;
    this->StartWrite(&queue_.front());
  }
  void finish_if_idle() {
    if (!ending_ || writing_ || finished_) return;
    finished_ = true;
    this->Finish(status_);
  }

  const std::uint64_t id_;
  grpc::CallbackServerContext* const context_;  ///< Owned by gRPC; invalid once done_.
  PeerStreamEvents<In, Out>& events_;

  std::mutex mutex_;  ///< Guards the following. gRPC makes no callbacks inside Start*() or Finish().
  In in_;
  std::deque<Out> queue_;  ///< While writing_ is set, the first message is being written.
  grpc::Status status_;
  bool writing_ = false;
  bool ending_ = false;
  bool finished_ = false;
  bool done_ = false;
  std::shared_ptr<PeerStream> self_;
};

}  // namespace cyclorama::coordinator
