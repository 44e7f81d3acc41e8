// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "appliance/display/head_sampler.h"
#include "appliance/display/shown_history.h"
#include "common/image/jpeg.h"
#include "common/wire/show.grpc.pb.h"

namespace cyclorama::display {

/// Implements show.proto's ShownPictures. Draws heads on gRPC's threads, one call at a time, and only pictures that the
/// caller does not have yet. Thread-safe. Borrows the history and the clock.
class ShownService final : public wire::ShownPictures::Service {
 public:
  /// `heads`: names of the output's heads, in the output's order.
  ShownService(std::vector<std::string> heads, ShownHistory* history, const Clock* clock)
      : heads_(std::move(heads)), history_(*history), clock_(*clock) {}

 private:
  grpc::Status GetShown(grpc::ServerContext* context, const wire::ShownRequest* request,
                        wire::ShownReply* reply) override;
  Status draw(const ShownSince& moment, int factor, wire::ShownMoment* reply);

  const std::vector<std::string> heads_;
  ShownHistory& history_;
  const Clock& clock_;
  std::mutex mutex_;  ///< Guards the members below.
  HeadPlans plans_;   ///< Plans for which the samplers were made.
  int factor_ = 0;
  std::vector<HeadSampler> samplers_;
  JpegEncoder encoder_;
};

}  // namespace cyclorama::display
