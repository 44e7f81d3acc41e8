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

/// Keeps a stream to one coordinator open, for ever.
///
///   dialling ──stream open──► serving ──stream ends──► dialling ...
///
/// Threads: `link` dials and reads orders, and, while a stream is open, `send` encodes and writes, and says once a
/// second how the node is. Keeps a reference to the controller, which must outlive it. Thread-safe.
class CoordinatorConnection {
 public:
  /// The coordinator's two connections: frames shall not queue behind files.
  struct Channels {
    std::shared_ptr<grpc::Channel> work;
    std::shared_ptr<grpc::Channel> files;
  };
  /// Starts to dial. `address` is how people call the coordinator; `hello` is what each stream begins with.
  CoordinatorConnection(std::string address, Channels channels, wire::NodeReport hello, NodeController& controller);
  ~CoordinatorConnection();
  CoordinatorConnection(const CoordinatorConnection&) = delete;
  CoordinatorConnection& operator=(const CoordinatorConnection&) = delete;

  /// Dials no more, and ends the stream when all is sent that was rendered.
  void finish();
  /// Waits for the end that finish() asked for; false at the deadline.
  bool wait_until_ended(TimePoint deadline);
  /// Ends the stream now and joins. Idempotent.
  void stop();

  /// One sentence for an operator: "serving the coordinator at [::1]:7402".
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
  grpc::ClientContext* context_ = nullptr;  ///< Of the current stream, so that stop() can cancel it.
  std::shared_ptr<NodeLink> link_;          ///< Likewise.
  std::string state_;

  std::thread thread_;
};

}  // namespace cyclorama::node
