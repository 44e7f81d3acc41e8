// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "common/base/clock.h"
#include "common/base/error.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/node/node_controller.h"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace cyclorama::node {

/// Keeps a stream to one coordinator open and reconnects whenever it ends.
///
///   connecting ──stream open──► serving ──stream ends──► connecting ...
///
/// Threads: `link` connects and reads orders; while a stream is open, `send` encodes, writes, and reports the node's
/// status once a second. Keeps a reference to the controller, which must outlive it. Thread-safe.
class CoordinatorConnection {
 public:
  /// Two connections to the coordinator, so that frames do not queue behind files.
  struct Channels {
    std::shared_ptr<grpc::Channel> work;
    std::shared_ptr<grpc::Channel> files;
  };
  /// Starts to connect. `address` names the coordinator in messages; `hello` is the first message of each stream.
  CoordinatorConnection(std::string address, Channels channels, wire::NodeReport hello, NodeController& controller);
  ~CoordinatorConnection();
  CoordinatorConnection(const CoordinatorConnection&) = delete;
  CoordinatorConnection& operator=(const CoordinatorConnection&) = delete;

  /// Stops reconnecting, and ends the stream once all rendered tiles have been sent.
  void finish();
  /// Waits until the stream has ended after finish(). Returns false at the deadline.
  bool wait_until_ended(TimePoint deadline);
  /// Ends the stream now and joins the threads. Idempotent.
  void stop();

  /// Returns one sentence for the operator, such as "serving the coordinator at [::1]:7402".
  [[nodiscard]] std::string state() const;

 private:
  void run();
  Error serve(bool* ret_served);
  [[nodiscard]] bool is_stopping() const;
  void set_state(std::string sentence);

  const std::string address_;
  const Channels channels_;
  const wire::NodeReport hello_;
  NodeController& controller_;

  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  bool ended_ = false;
  grpc::ClientContext* context_ = nullptr;  ///< Context of the current stream, so that stop() can cancel it.
  std::shared_ptr<NodeLink> link_;          ///< Link of the current stream.
  std::string state_;

  std::thread thread_;
};

}  // namespace cyclorama::node
