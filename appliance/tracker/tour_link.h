// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "appliance/tracker/interchange/pose_sender.h"
#include "common/base/latest_value.h"
#include "common/base/result.h"
#include "common/wire/museum.pb.h"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace cyclorama::tracker {

/// The tracker's connection to the tour: connects, streams poses, and reconnects without end, on a thread of its own,
/// `link`. A pose that cannot be sent at once is replaced by the next one; none is sent late. Thread-safe.
class TourLink {
 public:
  /// Errors: kInvalidArgument if `address` is not an address. An unreachable tour is no error.
  static Result<std::unique_ptr<TourLink>> open(const std::string& address);
  /// Cancels the stream and joins the thread; blocks for at most about half a second.
  ~TourLink();
  TourLink(const TourLink&) = delete;
  TourLink& operator=(const TourLink&) = delete;

  /// Sends `pose`, or replaces one that waits. Never blocks for long.
  void send(wire::TrackedPose pose);
  /// Also sends each pose to other programs. To be called before the first send().
  void also_send_to(PoseSender speaker) { pose_sender_ = std::move(speaker); }
  [[nodiscard]] bool is_connected() const { return connected_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  explicit TourLink(std::shared_ptr<grpc::Channel> channel);
  void run(const std::stop_token& stop);
  /// Streams until the tour disconnects or the thread is stopped.
  void stream(const std::stop_token& stop);

  std::shared_ptr<grpc::Channel> channel_;
  LatestValue<wire::TrackedPose> outbox_;
  std::optional<PoseSender> pose_sender_;
  std::atomic<bool> connected_ = false;
  std::atomic<std::uint64_t> sent_ = 0;
  std::mutex mutex_;
  grpc::ClientContext* context_ = nullptr;  ///< Context of the open stream; null between streams.
  std::jthread thread_;                     ///< Last member, since it uses all the others.
};

}  // namespace cyclorama::tracker
