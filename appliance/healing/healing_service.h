// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "appliance/healing/healing_loop.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::healing {

/// Implements show.proto's Healing. Thread-safe. Borrows the loop, which is null if nothing is watched.
class HealingService final : public wire::Healing::Service {
 public:
  explicit HealingService(HealingLoop* loop) : loop_(loop) {}
  /// Cancels running calls, and refuses new ones.
  void stop() { stop_.request_stop(); }

 private:
  grpc::Status PlaceCameras(grpc::ServerContext* context, const wire::PlaceCamerasRequest* request,
                            wire::PlacedCameras* reply) override;
  grpc::Status Realign(grpc::ServerContext* context, const wire::RealignRequest* request,
                       wire::RealignReply* reply) override;

  HealingLoop* loop_;
  std::mutex busy_;
  std::stop_source stop_;
};

}  // namespace cyclorama::healing
